// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/stress_peaks.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace ricochet::contact {

double von_mises(const double* s) noexcept {
  const double normal = std::pow(s[0] - s[1], 2) + std::pow(s[1] - s[2], 2) + std::pow(s[2] - s[0], 2);
  return std::sqrt(normal / 2 + 3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

StressPeaks::StressPeaks(const Model& model, const StepOptions& options, std::vector<MaterialLimits> limits)
    : model_(model), limits_(std::move(limits)), gauges_(model, options), largest_(model.bodies.size()) {
  limits_.resize(model.bodies.size());
  for (const Gauges::Gauge& gauge : gauges_.gauges())
    if (largest_[gauge.body].gauge == nullptr) largest_[gauge.body].gauge = gauge.kernel;
  if (options.scheme != Scheme::at_rest) note(0);
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
  for (const Gauges::Gauge& gauge : gauges_.gauges()) {
    const double stress = von_mises(&gauges_.values()[gauge.first]);
    if (stress > largest_[gauge.body].stress)
      largest_[gauge.body] = {.stress = stress, .time = time, .gauge = gauge.kernel};
  }
}

std::map<std::string, StressPeak> StressPeaks::peaks() const {
  std::map<std::string, StressPeak> out;
  for (std::size_t k = 0; k < largest_.size(); ++k) {
    const Largest& largest = largest_[k];
    if (largest.gauge == nullptr) continue;
    StressPeak& peak = out[model_.bodies[k].name];
    peak = {.gauge = largest.gauge->name,
            .at = Eigen::Vector3d(largest.gauge->point.data()),
            .von_mises_pa = largest.stress,
            .time_s = largest.time};
    if (limits_[k].yield > 0) peak.ratio_to_yield = largest.stress / limits_[k].yield;
  }
  return out;
}

std::vector<std::string> StressPeaks::warnings() const {
  std::vector<std::string> out;
  for (const auto& [body, peak] : peaks())
    if (peak.ratio_to_yield && *peak.ratio_to_yield > 1)
      out.push_back(fmt::format(
          "the stress at gauge {} of {} reaches {:.3g} MPa (von Mises) at {:.4g} s, {:.3g} times yield: it "
          "would deform permanently, which the model leaves out. Lower the load or the speed, or take a "
          "stronger material",
          peak.gauge, body, peak.von_mises_pa * 1e-6, peak.time_s, *peak.ratio_to_yield));
  return out;
}

}  // namespace ricochet::contact
