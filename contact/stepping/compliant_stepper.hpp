// SPDX-License-Identifier: BSD-2-Clause
// The compliant scheme, one step at a time: λ is constant over the step and solves, at its end,
//
//   0 ≤ λ ⟂ S λ − (û − g) ≥ 0,   û = B q̂ + s with q̂ the motion without contact,   S = B c Bᵀ + R
//
// Its energy theorem requires u ≤ g at the start, the static displacement s included. A step that max_pivots
// cuts short may end beyond g; from then on g̃ = max(g, u) at a step's start replaces g: a point beyond g may
// not go deeper, and is not pushed out, which would do work.
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
