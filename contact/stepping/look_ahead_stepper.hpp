// SPDX-License-Identifier: BSD-2-Clause
// The compliant scheme by look-ahead blocks. The steps equal those of CompliantStepper to round-off, and
// their cost depends only on the points that could close.
#pragma once

#include "contact/stepping/free_flight.hpp"
#include "contact/stepping/look_ahead_block.hpp"
#include "contact/stepping/stepper.hpp"

namespace ricochet::contact {

/// Number of steps in a block.
int look_ahead_length(const StepOptions& options, Eigen::Index rows);

/// @tparam T  type of the products of a block
template <class T>
class LookAheadStepper final : public Stepper {
 public:
  /// The model must have contact points. Throws as make_stepper does.
  LookAheadStepper(std::shared_ptr<const Model> model, const StepOptions& options);

  StepStatus step() noexcept override;
  std::unique_ptr<Stepper> clone() const override { return std::make_unique<LookAheadStepper>(*this); }
  void assign(const Stepper& clone) noexcept override { *this = static_cast<const LookAheadStepper&>(clone); }
  const ModalState* modal() const noexcept override { return &state_; }
  const Vector& displacement() const noexcept override;
  void keep(bool every_state, bool rates) noexcept override;
  int pending() const noexcept override { return pending_; }
  StepStatus catch_up() noexcept override;
  const double* rate(int back) const noexcept override;
  bool push_at(int body, const BodyPlace& place, const Eigen::Vector3d& force) noexcept override;
  void archive(base::Archive& a) override;

 private:
  void start_block() noexcept;
  StepStatus move_state() noexcept;

  ModalState state_;
  LookAheadBlock<T> block_;
  FreeFlight flight_;
  bool flew_ = false;  ///< the last step was a free flight
  bool keeps_rates_ = false;
  mutable bool u_is_current_ = true;
  Work at_points_;   ///< of the pending steps: with friction, and of a push that moves points at once
  int pending_ = 0;  ///< steps of the block that state_ does not include
  Contact known_;    ///< contact in the last step that state_ includes, for pending steps that fail
};

}  // namespace ricochet::contact
