// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/stress_peaks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "contact/figures/stress_measures.hpp"

namespace ricochet::contact {

bool has_stress(const Model& model) {
  return has_gauges(model) ||
         std::ranges::any_of(model.bodies, [](const auto& body) { return has_surface_stress(*body.kernel); });
}

std::string place_of(const StressPeak& peak) {
  if (!peak.gauge.empty()) return "gauge " + peak.gauge;
  return fmt::format("[{:.4g}, {:.4g}, {:.4g}] m", peak.at.x(), peak.at.y(), peak.at.z());
}

StressPeaks::StressPeaks(const Model& model, const StepOptions& options, std::vector<MaterialLimits> limits)
    : model_(model),
      limits_(std::move(limits)),
      gauges_(model, options),
      at_gauge_(gauges_.gauges().size()),
      surface_(model.bodies.size()) {
  limits_.resize(model.bodies.size());
  for (std::size_t k = 0; k < model.bodies.size(); ++k)
    if (has_surface_stress(*model.bodies[k].kernel)) surface_[k].emplace(*model.bodies[k].kernel);
  if (options.contact.scheme != Scheme::at_rest) note(0);
}

void StressPeaks::observe(const Stepper& stepper) noexcept {
  gauges_.observe(stepper);
  note(stepper.time());
}

void StressPeaks::observe(double time, const Vector& q, const Vector& p) noexcept {
  gauges_.set(time, q, p, nullptr);
  note(time);
}

void StressPeaks::note(double time) noexcept {
  for (std::size_t k = 0; k < surface_.size(); ++k)
    if (surface_[k]) surface_[k]->observe(time, gauges_.coordinates()[k]);
  for (std::size_t g = 0; g < at_gauge_.size(); ++g) {
    const Gauges::Gauge& gauge = gauges_.gauges()[g];
    const double* const values = &gauges_.values()[gauge.first];
    at_gauge_[g].von_mises.take(von_mises(values), time);
    if (gauge.kernel->strain) at_gauge_[g].strain.take(std::abs(values[stress_rows]), time);
  }
}

std::map<std::string, StressPeak> StressPeaks::peaks() const {
  std::map<std::string, StressPeak> out;
  for (std::size_t g = 0; g < at_gauge_.size(); ++g) {
    const Gauges::Gauge& gauge = gauges_.gauges()[g];
    const auto [peak, is_first] = out.try_emplace(model_.bodies[gauge.body].name);
    if (is_first || at_gauge_[g].von_mises.value > peak->second.von_mises_pa)
      peak->second = {.gauge = gauge.kernel->name,
                      .at = Eigen::Vector3d(gauge.kernel->point.data()),
                      .von_mises_pa = at_gauge_[g].von_mises.value,
                      .time_s = at_gauge_[g].von_mises.time};
  }
  for (std::size_t k = 0; k < surface_.size(); ++k) {
    const std::string& body = model_.bodies[k].name;
    if (surface_[k]) {
      const auto [found, is_first] = out.try_emplace(body);
      const StressEnvelope::Largest& of = surface_[k]->envelope().von_mises;
      const auto node = static_cast<std::size_t>(std::ranges::max_element(of.value) - of.value.begin());
      if (node < of.value.size() && (is_first || of.value[node] > found->second.von_mises_pa))
        found->second = {.gauge = "",
                         .at = Eigen::Vector3d(&model_.bodies[k].kernel->view->node[3 * node]),
                         .von_mises_pa = of.value[node],
                         .time_s = of.time[node]};
    }
    if (const auto peak = out.find(body); peak != out.end() && limits_[k].yield > 0)
      peak->second.ratio_to_yield = peak->second.von_mises_pa / limits_[k].yield;
  }
  return out;
}

std::map<std::string, GaugePeaks> StressPeaks::gauge_peaks() const {
  std::map<std::string, GaugePeaks> out;
  for (std::size_t g = 0; g < at_gauge_.size(); ++g) {
    const kernels::Gauge& gauge = *gauges_.gauges()[g].kernel;
    const auto& [von_mises, strain] = at_gauge_[g];
    GaugePeaks& peaks = out[gauge.name];
    peaks.von_mises_pa = von_mises.value;
    peaks.von_mises_time_s = von_mises.time;
    if (!gauge.strain) continue;
    peaks.strain_peak = strain.value;
    peaks.strain_time_s = strain.time;
  }
  return out;
}

std::map<std::string, StressEnvelope> StressPeaks::envelopes() const {
  std::map<std::string, StressEnvelope> out;
  for (std::size_t k = 0; k < surface_.size(); ++k)
    if (surface_[k]) out[model_.bodies[k].name] = surface_[k]->envelope();
  return out;
}

std::vector<std::string> StressPeaks::warnings() const {
  std::vector<std::string> out;
  for (const auto& [body, peak] : peaks())
    if (peak.ratio_to_yield && *peak.ratio_to_yield > 1)
      out.push_back(fmt::format(
          "the stress at {} of {} reaches {:.3g} MPa (von Mises) at {:.4g} s, {:.3g} times yield: it "
          "would deform permanently, which the model leaves out. Lower the load or the speed, or take a "
          "stronger material",
          place_of(peak), body, peak.von_mises_pa * 1e-6, peak.time_s, *peak.ratio_to_yield));
  return out;
}

}  // namespace ricochet::contact
