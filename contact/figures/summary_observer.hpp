// SPDX-License-Identifier: BSD-2-Clause
// Gathers the main results of one run, step by step.
#pragma once

#include <optional>

#include "contact/figures/band_share.hpp"
#include "contact/figures/linearity_check.hpp"
#include "contact/figures/obstacle_check.hpp"
#include "contact/figures/pressure_check.hpp"
#include "contact/figures/resolution_check.hpp"
#include "contact/figures/ripple_check.hpp"
#include "contact/figures/summary.hpp"
#include "contact/stepping/stepper.hpp"
#include "contact/table/table.hpp"

namespace ricochet::contact {

/// Observes a run. Call `observe` after each step.
class SummaryObserver {
 public:
  /// @param wave_speed  smallest √(E/ρ) of the bodies [m/s], for the warning on fast impacts; 0 if unknown,
  ///                    without this warning
  /// @param limits  by body, for warnings on pressure; empty: unknown
  /// `model` must outlive the observer.
  SummaryObserver(const Model& model, double step, double wave_speed,
                  std::vector<MaterialLimits> limits = {});

  /// Observes a run by sampled responses. Energies are not known, and there are no warnings. Restitution
  /// requires one free body, or two that press only on each other.
  /// @param source  the model from which the table was sampled, or null
  SummaryObserver(const Table& table, const Model* source, const StepOptions& options);

  void observe(const Stepper& stepper);

  /// The caller must set the elapsed times.
  Summary summary() const;

 private:
  void add_model(const Model& model);
  void begin();
  void count_forces(const Stepper& stepper);
  void observe_energy(const Energy& energy);
  Eigen::Matrix3Xd mean_velocities(double time) const;
  void push(const Vector& force);
  std::optional<double> closing_speed(const Eigen::Matrix3Xd& velocity,
                                      const Eigen::Matrix3Xd& impulse) const;
  void judge(Episode& episode, bool ended) const;
  void add_band(Summary& out) const;

  const Model* model_ = nullptr;  ///< null with a table
  std::vector<FreeBody> bodies_;  ///< of a table
  Vector gap_;                    ///< (m)
  double step_;
  Summary out_;
  bool touching_ = false;  ///< whether the last step had a force
  double last_touch_ = 0;  ///< last instant at which a point was in contact [s]
  Vector before_;  ///< at the end of the previous step: (N) q̇, or (3·bodies) velocities with a table
  Eigen::Matrix3Xd at_start_, at_end_;  ///< by body, mass-mean velocity when contact began and last ended
  Eigen::Matrix3Xd episode_start_;      ///< by body, mass-mean velocity when the last episode began
  Eigen::Matrix3Xd impulse_;            ///< Σ λ n Δ by pair; with a table by body [N s]
  Eigen::Matrix3Xd episode_impulse_;    ///< the same in the last episode
  Eigen::Matrix3Xd friction_impulse_;   ///< Σ τ Δ by pair [N s]
  Vector slipped_;                      ///< (f) path of each point with friction [m]
  std::optional<LinearityCheck> linearity_;
  std::optional<ResolutionCheck> resolution_;
  std::optional<ObstacleCheck> obstacles_;
  std::optional<BandShare> band_;
  std::optional<PressureCheck> pressure_;
  std::optional<RippleCheck> ripple_;
  std::int64_t observed_ = 0;  ///< number of steps
  double closest_;             ///< smallest distance of a pair of points at the end of a step [m]
  double initial_ledger_ = 0, worst_ledger_ = 0, largest_energy_ = 0;
  /// kinetic + strain at the end of the previous step, above the strain of the start at rest
  double energy_before_ = 0;
  double initial_strain_ = 0;
  double energy_at_start_ = 0, energy_lost_ = 0, heat_ = 0;
};

}  // namespace ricochet::contact
