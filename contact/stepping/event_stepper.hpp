// SPDX-License-Identifier: BSD-2-Clause
// The impulse scheme with event location. If points that were open at t_{k−1} close within the step, free
// motion ends at the first such instant, impulses act, and the rest of the step continues from there. Each
// point closes at most once per step. Points that touch at t_0 get their impulses there.
#pragma once

#include "contact/stepping/event_location.hpp"
#include "contact/stepping/impulse_problem.hpp"
#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {

class EventStepper final : public Stepper {
 public:
  /// Throws as make_stepper does.
  EventStepper(std::shared_ptr<const Model> model, const StepOptions& options);

  StepStatus step() noexcept override;
  std::unique_ptr<Stepper> clone() const override { return std::make_unique<EventStepper>(*this); }
  void assign(const Stepper& clone) noexcept override { *this = static_cast<const EventStepper&>(clone); }
  const ModalState* modal() const noexcept override { return &state_; }
  bool push_at(int body, const BodyPlace& place, const Eigen::Vector3d& force) noexcept override {
    return state_.push_at(body, place, force) != PushStatus::refused;
  }
  void archive(base::Archive& a) override;

 private:
  ModalState state_;
  ImpulseProblem problem_;
  EventLocation events_;
  Vector impulse_;  ///< (m) Σ P of the step
};

}  // namespace ricochet::contact
