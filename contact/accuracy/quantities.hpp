// What an impact comes to, as a few numbers that two runs can be compared by.
#pragma once

#include <cstdint>
#include <optional>

#include "contact/model/model.hpp"
#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {

/// Main results, each with the scale that its error is relative to. Runs of one scene have them in one order.
///
/// Of an impact: the impulse Σ λ_i Δ, over itself; and of each body that can move rigidly its mean velocity
/// when contact last ended (or the run did), over V: the largest speed at which a pair of bodies approached
/// when contact began, or half of the largest change of velocity where that is more (bodies that are pressed
/// together approach at no speed). With one free body an error of V is one of the coefficient of restitution.
/// Of bodies at rest: force and approach of each pair, over themselves.
struct Outcome {
  Vector value, scale;
  double longest_touch = 0;  ///< longest run of steps with a force [s]; at rest 0
  bool touched() const { return value.size() > 0 && value[0] > 0; }
};

/// Relative distance: max |a − b| / scale of a. Where a scale is 0, both have to be.
double distance(const Outcome& a, const Outcome& b);

/// @return none when a step has no solution or is not finite. Throws InputError as make_stepper does.
std::optional<Outcome> impact(const Model& model, const StepOptions& options, std::int64_t steps);

/// Throws as find_equilibrium does.
Outcome rest(const Model& model);

}  // namespace ricochet::contact
