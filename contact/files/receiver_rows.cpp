// SPDX-License-Identifier: BSD-2-Clause
#include "contact/files/receiver_rows.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace ricochet::contact {
namespace {

constexpr std::size_t width = 9;  ///< numbers of a receiver

}  // namespace

ReceiverRows::ReceiverRows(base::hdf5::Writer& file, const Model& model, const StepOptions& step, int every)
    : ReceiverRows(file, model, step, every, Kept{}) {}

ReceiverRows::ReceiverRows(base::hdf5::Writer& file, const Model& model, const StepOptions& step, int every,
                           Kept kept)
    : step_(step),
      every_(every),
      time_(&file.rows("/receivers/time", {}, "s")),
      row_(width * model.receivers.size()) {
  for (const Model::Receiver& receiver : model.receivers) {
    const std::string group = "/receivers/" + receiver.name;
    Datasets& made = datasets_.emplace_back();
    if (kept.displacement) made.displacement = &file.rows(group + "/displacement", {3}, "m");
    if (kept.velocity) made.velocity = &file.rows(group + "/velocity", {3}, "m/s");
    if (kept.acceleration) made.acceleration = &file.rows(group + "/acceleration", {3}, "m/s^2");
    file.attribute(group, "body", model.bodies[receiver.body].name);
    file.attribute(group, "axes", receiver.axes == Axes::body ? "body" : "world");
    file.attribute(group, "point", std::span<const double>(receiver.point.data(), 3));
  }
}

void ReceiverRows::record(const Receivers& motion) {
  for (std::size_t k = 0; k < motion.size(); ++k) {
    double* const row = row_.data() + width * k;
    std::ranges::copy(motion[k].displacement, row);
    std::ranges::copy(motion[k].velocity, row + 3);
    std::ranges::copy(motion[k].acceleration, row + 6);
  }
  if (!decimator_) {
    // Before t = 0, the receivers move at their initial velocities.
    std::vector<double> slope(row_.size(), 0);
    for (std::size_t k = 0; k < motion.size(); ++k)
      for (std::size_t c = 0; c < 3; ++c)
        slope[width * k + c] =
            motion[k].velocity[static_cast<Eigen::Index>(c)] * step_.step * step_.steps_per_sample;
    decimator_.emplace(every_, std::move(slope));
  }
  decimator_->push(row_, [this](std::int64_t sample, auto values) { append(sample, values); });
}

void ReceiverRows::finish() {
  if (decimator_) decimator_->finish([this](std::int64_t sample, auto values) { append(sample, values); });
}

void ReceiverRows::append(std::int64_t sample, std::span<const double> values) {
  time_->append(static_cast<double>(sample * step_.steps_per_sample) * step_.step);
  for (std::size_t k = 0; k < datasets_.size(); ++k) {
    const auto row = values.subspan(width * k, width);
    const std::array kept{datasets_[k].displacement, datasets_[k].velocity, datasets_[k].acceleration};
    for (std::size_t part = 0; part < kept.size(); ++part)
      if (kept[part] != nullptr) kept[part]->append(row.subspan(3 * part, 3));
  }
}

}  // namespace ricochet::contact
