// SPDX-License-Identifier: BSD-2-Clause
// Checks whether modes, candidates and steps resolve the contact of a run.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "contact/figures/impact_figures.hpp"
#include "contact/figures/peak_mean.hpp"
#include "contact/figures/peak_rise.hpp"
#include "contact/figures/rigid_motion.hpp"
#include "contact/model/model.hpp"
#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {

class ResolutionCheck {
 public:
  /// `model` must outlive the check.
  explicit ResolutionCheck(const Model& model);

  /// Call it after each step. @param before  (N) q̇ at the start of the step
  void observe(const Stepper& stepper, const Vector& before);

  /// @param figures  of the same run
  std::vector<std::string> warnings(const ImpactFigures& figures) const;

 private:
  double approach(const Stepper& stepper, const Vector& rates) const;
  double resolved() const;
  std::string front(const ImpactFigures& figures) const;
  std::string overshoot(const ImpactFigures& figures) const;
  std::string few_candidates() const;
  std::string better_order(const Model::PairBlock& pair, int point) const;
  std::string low_band(const ImpactFigures& figures) const;
  std::string faster_approach() const;

  const Model& model_;
  RigidMotions rigid_;
  double step_ = 0;             ///< Δ [s]
  double shortest_period_ = 0;  ///< of the modes that steps sample [s]; 0: no elastic mode
  PeakRise peak_;
  std::optional<PeakMean> mean_;  ///< over the shortest time that the run resolves; set by the first step
  std::vector<int> most_active_;  ///< by pair
  /// By pair: the largest force of a point so far [N], and this point.
  std::vector<std::pair<double, int>> strongest_;
  bool touching_ = false;
  int episodes_ = 0, fastest_episode_ = 0;
  double first_approach_ = 0, fastest_approach_ = 0;  ///< rigid approach when an episode began [m/s]
};

}  // namespace ricochet::contact
