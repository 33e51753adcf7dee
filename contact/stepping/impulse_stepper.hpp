// SPDX-License-Identifier: BSD-2-Clause
// The impulse scheme, algorithm (30) of the source paper. The bodies move freely from t_{k−1} to t_k, where
// impulses P on the points with u ≥ g change q̇. The first such instant is t_1. Points that touch at t_0 and
// approach therefore get their impulse one step later, and penetrate by at most Δ times their velocity.
#pragma once

#include "contact/stepping/impulse_problem.hpp"
#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {

class ImpulseStepper final : public Stepper {
 public:
  /// Throws as make_stepper does.
  ImpulseStepper(std::shared_ptr<const Model> model, const StepOptions& options);

  StepStatus step() noexcept override;
  std::unique_ptr<Stepper> clone() const override { return std::make_unique<ImpulseStepper>(*this); }
  void assign(const Stepper& clone) noexcept override { *this = static_cast<const ImpulseStepper&>(clone); }
  const ModalState* modal() const noexcept override { return &state_; }
  bool push_at(int body, const BodyPlace& place, const Eigen::Vector3d& force) noexcept override {
    return state_.push_at(body, place, force) != PushStatus::refused;
  }
  void archive(base::Archive& a) override;

 private:
  ModalState state_;
  ImpulseProblem problem_;
};

}  // namespace ricochet::contact
