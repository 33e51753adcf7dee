// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/rotation_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

namespace ricochet::contact {
namespace {

constexpr double largest_strain = 1e-3;  // (Ωr/c)²
constexpr double nearly_equal = 0.02;    // of the frequency: the rotation couples such modes
constexpr double most_turned = 0.1;      // [rad]: smaller turns of a pattern do not show

}  // namespace

RotationCheck::RotationCheck(const Model& model, double wave_speed)
    : model_(model), wave_speed_(wave_speed), bodies_(model.bodies.size()) {
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const Bodies::Block& block = model.bodies[k];
    const std::vector<double>& places = block.kernel->surface.places();
    for (std::size_t i = 0; i < places.size(); i += 3)
      bodies_[k].radius = std::max(
          bodies_[k].radius, (Eigen::Map<const Eigen::Vector3d>(&places[i]) - block.own_centre()).norm());
    const auto omega = model.omega.segment(block.first_mode, block.modes);
    for (int n = 0; n + 1 < block.modes && bodies_[k].first < 0; ++n)
      if (omega(n) > 0 && omega(n + 1) - omega(n) < nearly_equal * omega(n)) bodies_[k].first = n + 1;
  }
}

void RotationCheck::observe(const Stepper& stepper) {
  const double passed = stepper.time() - time_;
  time_ = stepper.time();
  for (std::size_t k = 0; k < stepper.poses().size(); ++k) {
    const double spin = stepper.poses()[k].spin.norm();
    bodies_[k].fastest = std::max(bodies_[k].fastest, spin);
    bodies_[k].turned += spin * passed;
  }
}

std::vector<std::string> RotationCheck::warnings() const {
  std::vector<std::string> out;
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const Body& body = bodies_[k];
    const std::string& name = model_.bodies[k].name;
    const double rim = body.fastest * body.radius / (wave_speed_ > 0 ? wave_speed_ : 1);
    if (wave_speed_ > 0 && rim * rim > largest_strain)
      out.push_back(fmt::format(
          "{} spins at {:.4g} rad/s: the centrifugal strain, about {:.2g} (above {:g}), is neglected", name,
          body.fastest, rim * rim, largest_strain));
    if (body.first > 0 && body.turned > most_turned)
      out.push_back(fmt::format(
          "modes {} and {} of {} differ by less than {:g} % in frequency: the rotation couples them "
          "(Coriolis), "
          "which is neglected, so their pattern may be off by up to the {:.3g} degrees that the body turns",
          body.first, body.first + 1, name, 100 * nearly_equal, body.turned * 180 / std::numbers::pi));
  }
  return out;
}

}  // namespace ricochet::contact
