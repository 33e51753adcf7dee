// SPDX-License-Identifier: BSD-2-Clause
// Quantities of interest: the few numbers by which two runs of one scene are compared.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "contact/model/model.hpp"
#include "ricochet/step_options.hpp"

namespace ricochet::contact {

/// Main results, each with the scale that its error is relative to. Runs of one scene list them in one order.
///
/// Impact: the impulse Σ λ_i Δ, relative to itself; and for each body that can move rigidly its mean velocity
/// when contact last ended (or the run did), relative to V: the largest speed at which a pair of bodies
/// approached when contact began, or half of the largest change of velocity where that is more (bodies that
/// are pressed together approach at no speed). With one free body an error of V is one of the coefficient of
/// restitution. Bodies at rest: force and approach of each pair, relative to themselves.
struct Quantities {
  Vector value, scale;
  double longest_touch = 0;  ///< longest run of steps with a force [s]; at rest 0
  bool touched() const { return value.size() > 0 && value[0] > 0; }
};

/// Relative distance: max |a − b| / scale of a. Where a scale is 0, both values have to be equal.
double distance(const Quantities& a, const Quantities& b);

/// @param poll  called after each step; it may throw to end the run
/// @return none when a step has no solution or is not finite. Throws InputError as make_stepper does.
std::optional<Quantities> impact_quantities(const Model& model, const StepOptions& options,
                                            std::int64_t steps, const std::function<void()>& poll = {});

/// Throws as find_equilibrium does.
Quantities rest_quantities(const Model& model);

}  // namespace ricochet::contact
