// SPDX-License-Identifier: BSD-2-Clause
// Gathers the figures of one run, step by step.
#pragma once

#include <optional>

#include "contact/output/linearity_check.hpp"
#include "contact/output/summary.hpp"
#include "contact/stepping/stepper.hpp"
#include "contact/table/table.hpp"

namespace ricochet::contact {

/// Observes a run. `observe` is called after each step.
class SummaryObserver {
 public:
  /// @param wave_speed  smallest √(E/ρ) of the bodies [m/s], for the warning on fast impacts; 0: unknown, no
  /// warning. `model` outlives the observer.
  SummaryObserver(const Model& model, double step, double wave_speed);

  /// A run by table kernels: energies are not known, and no warnings are given. Restitution requires one free
  /// body, or two that press on each other alone.
  /// @param source  the model that the table was sampled from, or null
  SummaryObserver(const Table& table, const Model* source, const StepOptions& options);

  void observe(const Stepper& stepper);

  /// The times are the caller's to fill.
  Summary summary() const;

 private:
  void add_model(const Model& model);
  void count_forces(const Vector& force, double time);
  void observe_energy(const Energy& energy);
  Eigen::Matrix3Xd mean_velocities(double time) const;
  void push(const Vector& force);
  std::optional<double> closing_speed(const Eigen::Matrix3Xd& velocity) const;

  const Model* model_ = nullptr;  ///< null with a table
  std::vector<FreeBody> bodies_;  ///< of a table
  Vector gap_;                    ///< (m)
  double step_;
  Summary out_;
  bool touching_ = false;
  Vector
      before_;  ///< rates at the end of the step before: (N) q̇, or (3·bodies) velocities of a table's bodies
  Eigen::Matrix3Xd at_start_, at_end_;  ///< by body, mass-mean velocity when contact started, last ended
  Eigen::Matrix3Xd impulse_;            ///< Σ λ n Δ by pair; with a table by body [N s]
  std::optional<LinearityCheck> check_;
  double initial_ledger_ = 0, worst_ledger_ = 0, largest_energy_ = 0;
  double energy_before_ = 0;  ///< kinetic + strain at the end of the step before
  double energy_at_start_ = 0, energy_lost_ = 0;
};

}  // namespace ricochet::contact
