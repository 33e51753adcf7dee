// SPDX-License-Identifier: BSD-2-Clause
// Gathers the main results of one run, step by step.
#pragma once

#include <optional>
#include <vector>

#include "contact/figures/acceleration_observer.hpp"
#include "contact/figures/band_share.hpp"
#include "contact/figures/figure_observer.hpp"
#include "contact/figures/run_checks.hpp"
#include "contact/figures/stress_peaks.hpp"
#include "contact/figures/summary.hpp"
#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {

/// Observes a run. Call `observe` after each step. With sampled responses, energies are not known, and there
/// are no warnings.
class SummaryObserver {
 public:
  /// @param wave_speed  smallest √(E/ρ) of the bodies [m/s], for the warning on fast impacts; 0 if unknown,
  ///                    without this warning
  /// @param limits  by body, for warnings on pressure and stress; empty: unknown
  SummaryObserver(const MotionSource& source, double step, double wave_speed,
                  std::vector<MaterialLimits> limits = {});

  /// Begins where a stepper is, after steps that were not observed.
  void begin(const Stepper& stepper) { figures_.begin(stepper); }
  void observe(const Stepper& stepper);

  /// With linear rotations; 0 with finite ones, and with sampled responses.
  FarthestTurn farthest_turn() const { return checks_ ? checks_->farthest_turn() : FarthestTurn{}; }

  const FigureObserver& figures() const { return figures_; }
  /// What is doubtful in the steps so far, whether or not more follow.
  std::vector<std::string> warnings() const { return warnings(figures_.figures()); }
  /// The caller must set the elapsed times.
  Summary summary() const;

 private:
  void observe_friction(const Model& model, const Stepper& stepper);
  void observe_energy(const Energy& energy);
  void add_band(Summary& out) const;
  std::vector<std::string> warnings(const ImpactFigures& figures) const;

  FigureObserver figures_;
  std::optional<RunChecks> checks_;                   ///< with modes
  std::optional<BandShare> band_;                     ///< with modes
  std::optional<AccelerationObserver> acceleration_;  ///< with receivers, from the first step on
  std::optional<StressPeaks> stress_;                 ///< where there is stress, from the first step on
  double step_;
  std::vector<MaterialLimits> limits_;
  Summary out_;
  Eigen::Matrix3Xd friction_impulse_;  ///< Σ τ Δ by pair [N s]
  Vector slipped_;                     ///< (f) path of each point with friction [m]
  double initial_ledger_ = 0, worst_ledger_ = 0, largest_energy_ = 0;
  double energy_lost_ = 0, heat_ = 0;
};

}  // namespace ricochet::contact
