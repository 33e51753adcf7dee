// SPDX-License-Identifier: BSD-2-Clause
// Quantities of interest: the few numbers by which runs of one scene are compared.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "contact/model/model.hpp"
#include "ricochet/step_options.hpp"

namespace ricochet::contact {

/// The main results of a run, each with the scale to which its error is relative. All runs of one scene list
/// them in the same order.
///
/// For an impact, these are the impulse Σ λ_i Δ, relative to itself, and the mean velocity of each body that
/// can move rigidly. Velocities are those when contact last ended, or at the end of the run if bodies still
/// touch. They are relative to V, the largest speed at which a pair of bodies approached when contact began,
/// or half of the largest change of velocity if that is larger (bodies that are pressed together have no
/// approach speed). With one free body, the relative error of its velocity is thus the error of the
/// coefficient of restitution.
///
/// For bodies at rest, the quantities are the force and the approach of each pair, relative to themselves.
struct Quantities {
  Vector value, scale;
  double longest_touch = 0;  ///< longest uninterrupted sequence of steps with a force [s]; 0 at rest
  bool touched() const { return value.size() > 0 && value[0] > 0; }
};

/// Relative distance: max |a − b| / scale of a. If a scale is 0, the distance is infinite unless both values
/// are equal.
double distance(const Quantities& a, const Quantities& b);

/// @param poll  called after each step; it may throw to end the run
/// @return no value if a step has no solution or is not finite
/// Throws InputError as make_stepper does.
std::optional<Quantities> impact_quantities(const Model& model, const StepOptions& options,
                                            std::int64_t steps, const std::function<void()>& poll = {});

/// Throws as find_equilibrium does.
Quantities rest_quantities(const Model& model);

}  // namespace ricochet::contact
