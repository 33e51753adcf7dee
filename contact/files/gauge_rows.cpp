// SPDX-License-Identifier: BSD-2-Clause
#include "contact/files/gauge_rows.hpp"

namespace ricochet::contact {

GaugeRows::GaugeRows(base::hdf5::Writer& file, const Model& model, const StepOptions& step, int every)
    : sample_(step.step * step.steps_per_sample),
      gauges_(model, step),
      // Before t = 0, stresses are those at the start.
      decimator_(every, std::vector<double>(gauges_.values().size(), 0)),
      time_(&file.rows("/gauges/time", {}, "s")) {
  for (const Gauges::Gauge& gauge : gauges_.gauges()) {
    const std::string group = "/gauges/" + gauge.kernel->name;
    Datasets& made = datasets_.emplace_back();
    made.stress = &file.rows(group + "/stress", {kernels::stress_rows}, "Pa");
    if (gauge.kernel->strain) made.strain = &file.rows(group + "/strain", {}, "1");
    file.attribute(group, "body", model.bodies[gauge.body].name);
    file.attribute(group, "point", std::span<const double>(gauge.kernel->point));
  }
  if (step.contact.scheme != Scheme::at_rest) push();
}

void GaugeRows::push() {
  decimator_.push(gauges_.values(), [this](std::int64_t sample, auto values) {
    append(static_cast<double>(sample) * sample_, values);
  });
}

void GaugeRows::record(const Stepper& stepper) {
  gauges_.observe(stepper);
  push();
}

void GaugeRows::record(double time, const Vector& q, const Vector& p) {
  gauges_.set(time, q, p, nullptr);
  append(time, gauges_.values());
}

void GaugeRows::finish() {
  decimator_.finish(
      [this](std::int64_t sample, auto values) { append(static_cast<double>(sample) * sample_, values); });
}

void GaugeRows::append(double time, std::span<const double> values) {
  time_->append(time);
  for (std::size_t k = 0; k < datasets_.size(); ++k) {
    const std::size_t first = gauges_.gauges()[k].first;
    datasets_[k].stress->append(values.subspan(first, kernels::stress_rows));
    if (datasets_[k].strain != nullptr) datasets_[k].strain->append(values[first + kernels::stress_rows]);
  }
}

}  // namespace ricochet::contact
