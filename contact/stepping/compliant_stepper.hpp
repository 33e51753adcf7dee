// SPDX-License-Identifier: BSD-2-Clause
// The compliant scheme, one step at a time: λ⁺ solves, at the end of the step,
//
//   0 ≤ λ⁺ ⟂ S λ⁺ − (û − M h − g) ≥ 0,   û = B q̂ + s with q̂ the motion without contact,   S = a M + R
//
// and drives the modes by its mean with earlier forces (mean_force.hpp).
//
// The energy theorem of this scheme requires u ≤ g at the start, where u includes the static displacement s.
// A step that max_pivots cuts short may end with u > g. From then on, g̃ = max(g, u) at the start of a step
// replaces g: a point beyond g cannot go deeper, and it is not pushed out, because that would do work.
#pragma once

#include "contact/stepping/free_flight.hpp"
#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {

class CompliantStepper final : public Stepper {
 public:
  /// Throws as make_stepper does.
  CompliantStepper(const Model& model, const StepOptions& options);

  StepStatus step() noexcept override;
  std::unique_ptr<Stepper> clone() const override { return std::make_unique<CompliantStepper>(*this); }
  void assign(const Stepper& clone) noexcept override { *this = static_cast<const CompliantStepper&>(clone); }
  const ModalState* modal() const noexcept override { return &state_; }
  const Vector& displacement() const noexcept override;

 private:
  MeanForce::Trial attempt(const MeanWeights& weights) noexcept;

  ModalState state_;
  FreeFlight flight_;
  mutable bool u_is_current_ = true;
  Vector free_u_, rhs_;     ///< (m) û; right side of the problem
  Vector rest_, rest_end_;  ///< (m) R λ, R λ⁺
  SolveResidual residual_;
};

}  // namespace ricochet::contact
