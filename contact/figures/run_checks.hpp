// SPDX-License-Identifier: BSD-2-Clause
// All checks of a run whose modes are known.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "contact/figures/figure_observer.hpp"
#include "contact/figures/linearity_check.hpp"
#include "contact/figures/obstacle_check.hpp"
#include "contact/figures/pressure_check.hpp"
#include "contact/figures/resolution_check.hpp"
#include "contact/figures/ripple_check.hpp"
#include "contact/figures/rotation_check.hpp"

namespace ricochet::contact {

class RunChecks {
 public:
  /// @param wave_speed, limits  as for LinearityCheck and PressureCheck. `model` must outlive the checks.
  RunChecks(const Model& model, double step, double wave_speed, std::vector<MaterialLimits> limits);

  /// Call it after each step. @param figures  which have observed this step
  void observe(const Stepper& stepper, const FigureObserver& figures);

  FarthestTurn farthest_turn() const { return linearity_.farthest_turn(); }
  std::map<std::string, Neglected> neglected() const { return rotation_.neglected(); }
  std::vector<std::string> warnings(const ImpactFigures& figures) const;

 private:
  RigidMotions rigid_;
  LinearityCheck linearity_;
  ResolutionCheck resolution_;
  ObstacleCheck obstacles_;
  PressureCheck pressure_;
  RippleCheck ripple_;
  RotationCheck rotation_;
  std::int64_t observed_ = 0;  ///< number of steps
};

}  // namespace ricochet::contact
