// SPDX-License-Identifier: BSD-2-Clause
// Advances the contact forces of a Table in time. This is the formulation of the source paper, in which the
// motion of the contact points is a convolution with all earlier forces.
//
// impulse, step k: û_k = ũ_k − Σ_{l≥1} N_l P_{k−l}; on the points with û ≥ g, to round-off,
//   0 ≤ P ⟂ A P − (1 + e) v̂ ≥ 0
//   "jump":        A = Ṅ_0,    v̂ = ũ̇_k − Σ_{l≥1} Ṅ_l P_{k−l}
//   "difference":  the same with (N_{l+1} − N_l)/Δ for Ṅ_l and (ũ_{k+1} − ũ_k)/Δ for ũ̇_k
// The first instant is t_1, as in the source paper. displacement() is u before the impulses.
//
// compliant, step k: 0 ≤ λ⁺ ⟂ S λ⁺ − (û − M h − g) ≥ 0,  û = ũ_k − Σ_{l≥1} S_l λ̄_{k−l},  over all points,
// with M = S_0 − R and the means of mean_force.hpp. Without R, steps are by backward Euler.
//
// With responses sampled from modes, both equal the modal schemes to round-off. The energy of the bodies is
// unknown here, and whether a step can gain energy depends on the table. persistency() is known only for
// `compliant`.
#pragma once

#include <Eigen/Dense>
#include <limits>
#include <vector>

#include "contact/stepping/stepper.hpp"
#include "contact/table/convolution.hpp"
#include "contact/table/table.hpp"

namespace ricochet::contact {

class TableStepper final : public Stepper {
 public:
  /// Value of available() without a limit.
  static constexpr std::int64_t endless = std::numeric_limits<std::int64_t>::max();

  /// @param table  valid; not needed afterwards
  /// Throws InputError if the table lacks data that the scheme needs, if its step differs from that of
  /// `options`, if its lag 0 (A or S_0) is not symmetric and positive semidefinite, or if restitution is
  /// outside [0, 1].
  TableStepper(const Table& table, const StepOptions& options);

  /// Number of steps for which the table has responses and free motion.
  std::int64_t available() const { return available_; }

  /// Returns `table_ended`, without any change, if the step is beyond `available`.
  StepStatus step() noexcept override;
  std::unique_ptr<Stepper> clone() const override { return std::make_unique<TableStepper>(*this); }
  void assign(const Stepper& clone) noexcept override { *this = static_cast<const TableStepper&>(clone); }
  const Eigen::Matrix3Xd* body_velocities() const noexcept override { return &velocity_; }

 private:
  void free_motion(std::int64_t k, Vector& u) const noexcept;
  void free_rate(std::int64_t k, Vector& v) const noexcept;
  SolveStatus impulses() noexcept;
  void push_bodies() noexcept;

  std::int64_t available_ = endless;
  std::vector<double> free_, free_velocity_;    ///< (K,m), (·,m)
  Vector rigid_velocity_, rigid_acceleration_;  ///< (m) of ũ, if `free_` is empty
  Vector gap_;
  Eigen::MatrixXd S_;           ///< (m,m) S_0 or A
  Eigen::MatrixXd R_, S_mean_;  ///< (m,m) R; a M + R; empty unless steps are conserving
  std::vector<FreeBody> bodies_;
  Convolution convolution_;  ///< compliant: S (m rows); impulse: N and Ṅ (2m rows)
  Eigen::Matrix3Xd velocity_;

  // The current step
  Vector rhs_, solution_, rate_;  ///< (m)
  Eigen::MatrixXd sub_;
  std::vector<int> touching_;
};

}  // namespace ricochet::contact
