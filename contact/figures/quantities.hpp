// SPDX-License-Identifier: BSD-2-Clause
// The quantities of interest of one run, and facts about its contact, for error estimates.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "contact/figures/figure.hpp"
#include "contact/figures/linearity_check.hpp"
#include "contact/model/model.hpp"
#include "ricochet/step_options.hpp"

namespace ricochet::contact {

struct Quantities {
  Figures figures;
  /// The longest touch [s]; 0 at rest. Truncated fronts open a contact for moments: gaps of up to two steps,
  /// or a tenth of the touch so far, do not end it.
  double longest_touch = 0;
  std::vector<bool> pressed{};  ///< (m) points with a force in some step; empty at rest
  std::vector<double> force{};  ///< Σ λ_i of each step [N]; empty at rest
  Vector impulse{};             ///< (n) impulses of the rows [N s]; empty at rest
  double nearer = 0;            ///< farthest rigid approach of pressed points [m]; 0 at rest
  FarthestTurn turn{};          ///< with linear rotations; otherwise, and at rest, 0
  /// If nothing touched in an impact: the smallest distance of a pair of points [m], and the side of a square
  /// with the area of this point [m].
  double missed_by = std::numeric_limits<double>::infinity(), spacing_there = 0;
  bool touched() const;
  /// Whether bodies land again, or chatter: no touch has three quarters of the contact.
  bool touches_repeat() const;
};

/// Relative error of each quantity of `b`, with the scales of `a`.
Errors distances(const Quantities& a, const Quantities& b);

/// @param receivers  whether to record the motion of receivers too
/// @param poll  called after each step; it may throw to end the run
/// @return no value if a step has no solution or is not finite
/// Throws InputError as make_stepper does.
std::optional<Quantities> impact_quantities(const Model& model, const StepOptions& options,
                                            std::int64_t steps, bool receivers = false,
                                            const std::function<void()>& poll = {});

/// Throws as find_equilibrium does.
Quantities rest_quantities(const Model& model);

}  // namespace ricochet::contact
