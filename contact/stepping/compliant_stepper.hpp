// SPDX-License-Identifier: BSD-2-Clause
// The compliant scheme, one step at a time: û = B q̂ + s with q̂ the motion without contact, the contact step
// of contact/law, and the modes under its mean force.
#pragma once

#include "contact/stepping/free_flight.hpp"
#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {

class CompliantStepper final : public Stepper {
 public:
  /// Throws as make_stepper does.
  CompliantStepper(std::shared_ptr<const Model> model, const StepOptions& options);

  StepStatus step() noexcept override;
  std::unique_ptr<Stepper> clone() const override { return std::make_unique<CompliantStepper>(*this); }
  void assign(const Stepper& clone) noexcept override { *this = static_cast<const CompliantStepper&>(clone); }
  const ModalState* modal() const noexcept override { return &state_; }
  bool push_at(int body, const BodyPlace& place, const Eigen::Vector3d& force) noexcept override {
    return state_.push_at(body, place, force) != PushStatus::refused;
  }
  void archive(base::Archive& a) override;
  const Vector& displacement() const noexcept override;

 private:
  ModalState state_;
  std::shared_ptr<const RowMatrices> matrices_;
  FreeFlight flight_;
  mutable bool u_is_current_ = true;
};

}  // namespace ricochet::contact
