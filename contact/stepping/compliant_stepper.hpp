// SPDX-License-Identifier: BSD-2-Clause
// The compliant scheme, one step at a time: λ is constant over the step and solves, at its end,
//
//   0 ≤ λ ⟂ S λ − (û − g) ≥ 0,   û = B q̂ + s with q̂ the motion without contact,   S = B c Bᵀ + R
//
// The energy theorem of this scheme requires u ≤ g at the start, where u includes the static displacement s.
// A step that max_pivots cuts short may end with u > g. From then on, g̃ = max(g, u) at the start of a step
// replaces g: a point beyond g cannot go deeper, and it is not pushed out, because that would do work.
#pragma once

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

 private:
  ModalState state_;
  Vector rhs_;  ///< (m)
};

}  // namespace ricochet::contact
