// SPDX-License-Identifier: BSD-2-Clause
// The compliant scheme, one step at a time: p⁺, that is λ⁺ and τ⁺, solves at the end of the step
//
//   0 ≤ λ⁺ ⟂ S p⁺ − (û − M h − g) ≥ 0,   û = B q̂ + s with q̂ the motion without contact,   S = a M + R
//   Coulomb's law for τ⁺ and the slip d = û − M h − S p⁺ − u − belt of the tangential rows
//
// and drives the modes by its mean with earlier forces (mean_force.hpp). Springs of the points add s(λ⁺) to
// the left side, S p⁺ (patch_spring.hpp).
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
  void record_slip(const FrictionSolver* solver, MeanForce::Trial& trial) noexcept;

  Vector free_u_, rhs_;     ///< (n) û; right side of the problem
  Vector rest_, rest_end_;  ///< (n) R p, R p⁺
  std::vector<FrictionContact> contacts_;
  SolveResidual residual_;
};

}  // namespace ricochet::contact
