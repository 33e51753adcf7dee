// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/compliant_stepper.hpp"

#include "base/archive.hpp"

namespace ricochet::contact {

CompliantStepper::CompliantStepper(std::shared_ptr<const Model> model, const StepOptions& options)
    : Stepper(options, *model),
      state_(std::move(model), options),
      matrices_(std::make_shared<const RowMatrices>(*state_.system)),
      flight_(*state_.system, options) {
  state_.displacement(contact_.mean.end(), u_);
}

StepStatus CompliantStepper::step() noexcept {
  if (contact_.mean.begins())
    if (const int crossed = flight_.cross(state_, steps_); crossed > 0) {
      land(crossed);
      u_is_current_ = false;
      return StepStatus::ok;
    }
  const StepSystem& system = *state_.system;
  Slip* const slip = contact_.slip.any() ? &contact_.slip : nullptr;
  state_.begin(steps_ + 1);
  contact_.slip.begin(system.model->belts, steps_ + 1);
  law_.start = displacement();
  law_.free = state_.now.s;
  law_.free.noalias() += system.model->B * state_.next_q;
  const StepTrial trial = law_.solve(matrices_->all(), contact_.mean, slip);
  if (!has_forces(trial.status)) return failure(trial.status);
  next_force_ = law_.force();
  next_end_ = law_.end();
  next_u_ = law_.u();
  const Work at_points = work_of(trial, state_.energy().residual);
  if (!state_.step_under(next_force_, trial.in_residual, slip != nullptr ? &at_points : nullptr))
    return StepStatus::not_finite;
  if (trial.several) ++contact_.ambiguous;
  const Eigen::Index m = points();
  return complete(static_cast<int>((next_end_.head(m).array() > 0).count()),
                  -next_force_.head(m).dot((next_u_ - u_).head(m)) / options_.step, trial.violation);
}

const Vector& CompliantStepper::displacement() const noexcept {
  if (!u_is_current_) state_.displacement(contact_.mean.end(), u_);
  u_is_current_ = true;
  return u_;
}

void CompliantStepper::archive(base::Archive& a) {
  archive_contact(a);
  a(state_, u_is_current_);
}

}  // namespace ricochet::contact
