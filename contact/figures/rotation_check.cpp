// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/rotation_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ricochet::contact {
namespace {

constexpr double largest_strain = 1e-3;  // (Ωr/c)²
constexpr double most_turned = 0.1;      // [rad]: smaller turns of a pattern do not show
constexpr double most_mixed = 0.01;      // of the amplitude: likewise

}  // namespace

RotationCheck::RotationCheck(const Model& model, double wave_speed)
    : model_(model), wave_speed_(wave_speed), bodies_(model.bodies.size()) {
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const Bodies::Block& block = model.bodies[k];
    Body& body = bodies_[k];
    body.radius = block.radius();
    const auto omega = model.omega.segment(block.first_mode, block.modes);
    const bool coupled = !block.kernel->modes.coriolis.pair.empty();
    int modes = block.modes;
    while (modes > 0 && std::ranges::binary_search(model.folded.modes, block.first_mode + modes - 1)) --modes;
    for (int m = 0; m < modes; ++m) {
      if (omega(m) == 0) continue;
      if (body.lowest == 0) body.lowest = omega(m);
      int n = m + 1;
      while (coupled && n < modes && kernels::nearly_equal(omega(m), omega(n))) ++n;
      if (n == modes || (body.apart > 0 && omega(n) - omega(m) >= body.apart)) continue;
      // Modes that differ by round-off alone are as far apart as round-off.
      body.apart = std::max(omega(n) - omega(m), 1e-15 * omega(m));
      body.first = kernels::nearly_equal(omega(m), omega(n)) ? m + 1 : -1;
    }
  }
}

void RotationCheck::observe(const Stepper& stepper) {
  const double passed = stepper.time() - time_;
  time_ = stepper.time();
  turns_ = !stepper.poses().empty();
  for (std::size_t k = 0; k < stepper.poses().size(); ++k) {
    const double spin = stepper.poses()[k].spin.norm();
    bodies_[k].fastest = std::max(bodies_[k].fastest, spin);
    bodies_[k].turned += spin * passed;
  }
}

Neglected RotationCheck::neglected(const Body& body) const {
  Neglected out;
  if (wave_speed_ > 0) out.centrifugal_strain = std::pow(body.fastest * body.radius / wave_speed_, 2);
  if (body.lowest > 0) out.frequency_shift = std::pow(body.fastest / body.lowest, 2);
  if (body.apart > 0) out.mode_mixing = std::min(1.0, 2 * body.fastest / body.apart);
  return out;
}

std::map<std::string, Neglected> RotationCheck::neglected() const {
  std::map<std::string, Neglected> out;
  for (std::size_t k = 0; k < bodies_.size() && turns_; ++k)
    if (const Bodies::Block& block = model_.bodies[k]; !block.supported) {
      Neglected& sizes = out[block.name] = neglected(bodies_[k]);
      if (const auto& compact = block.kernel->surface.compact) sizes.compression = compact->error;
    }
  return out;
}

std::vector<std::string> RotationCheck::warnings() const {
  std::vector<std::string> out;
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const Body& body = bodies_[k];
    const std::string& name = model_.bodies[k].name;
    const Neglected sizes = neglected(body);
    if (sizes.centrifugal_strain.value_or(0) > largest_strain)
      out.push_back(fmt::format(
          "{} spins at {:.4g} rad/s: the centrifugal strain, about {:.2g} (above {:g}), is neglected", name,
          body.fastest, *sizes.centrifugal_strain, largest_strain));
    if (body.first > 0 && body.turned > most_turned && sizes.mode_mixing > most_mixed)
      out.push_back(fmt::format(
          "modes {} and {} of {} are nearly equal, and its kernel lacks their coupling by the rotation "
          "(Coriolis): their pattern may be off by up to the {:.3g} degrees that the body turns. Compute the "
          "kernel again, from a mesh or from matrices",
          body.first, body.first + 1, name, body.turned * 180 / std::numbers::pi));
  }
  return out;
}

}  // namespace ricochet::contact
