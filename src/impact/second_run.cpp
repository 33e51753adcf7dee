// SPDX-License-Identifier: BSD-2-Clause
#include "src/impact/second_run.hpp"

#include <algorithm>
#include <cmath>
#include <exception>

#include "contact/stepping/step_system.hpp"

namespace ricochet::impact {
namespace {

constexpr double faster = 1.005;
/// Poses that are compared: of a run whose end is known, and of one that may end at any time before.
constexpr std::int64_t most_records = 2000, most_of_open_end = 100'000;
constexpr double share_of_radius = 0.5, share_of_way = 0.05;

/// The model with larger speeds; of bodies that fall from rest, with a larger gravity.
std::shared_ptr<const contact::Model> perturbed(const contact::Model& model) {
  auto out = std::make_shared<contact::Model>(model);
  out->v0 *= faster;
  if (model.v0.isZero(0)) out->gravity *= faster * faster;
  return out;
}

}  // namespace

SecondRun::SecondRun(const Impact& impact)
    : impact_(impact),
      samples_(impact.samples()),
      every_(std::max<std::int64_t>(
          1, impact.samples() / (impact.scene.time.until_parted ? most_of_open_end : most_records))) {
  for (const contact::Bodies::Block& body : impact.model->bodies) radius_.push_back(body.radius());
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

void SecondRun::record(const contact::Stepper& stepper, std::vector<Poses>& records) const {
  if (stepper.at_sample() && stepper.steps() / stepper.options().steps_per_sample % every_ == 0)
    records.emplace_back(stepper.poses().begin(), stepper.poses().end());
}

/// Ends where a step fails: what the first run does then is not known to be otherwise.
void SecondRun::run(const std::stop_token& stop) {
  StepOptions options = impact_.options;
  const int steps = options.steps_per_sample++;
  options.step *= static_cast<double>(steps) / options.steps_per_sample;
  try {
    const auto stepper = contact::make_stepper(perturbed(*impact_.model), options);
    while (!stop.stop_requested() && stepper->steps() < samples_ * options.steps_per_sample &&
           stepper->step() == StepStatus::ok)
      record(*stepper, second_);
  } catch (const std::exception&) {
  }
}

void SecondRun::observe(const contact::Stepper& first) { record(first, first_); }

std::optional<double> SecondRun::separation(std::int64_t samples) {
  samples_ = samples;
  thread_.join();
  const double time = static_cast<double>(every_ * impact_.options.steps_per_sample) * impact_.options.step;
  std::vector<double> way(radius_.size(), 0);
  for (std::size_t k = 0; k < std::min(first_.size(), second_.size()); ++k)
    for (std::size_t body = 0; body < radius_.size(); ++body) {
      const contact::Pose &one = first_[k][body], &two = second_[k][body];
      const double radius = radius_[body];
      way[body] += time * (one.velocity.norm() + radius * one.spin.norm());
      const double apart =
          (one.position - two.position).norm() + radius * one.attitude.angularDistance(two.attitude);
      if (apart > std::max(share_of_radius * radius, share_of_way * way[body]))
        return static_cast<double>(k + 1) * time;
    }
  return std::nullopt;
}

}  // namespace ricochet::impact
