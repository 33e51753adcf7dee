// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/compliant_stepper.hpp"

namespace ricochet::contact {

CompliantStepper::CompliantStepper(const Model& model, const StepOptions& options)
    : Stepper(options, model.gap.size(), {.same_matrix = true, .max_pivots = options.max_pivots}),
      state_(model, options) {
  rhs_.setZero(model.gap.size());
  state_.displacement(contact_.force, u_);
}

StepStatus CompliantStepper::step() noexcept {
  const StepSystem& system = *state_.system;
  state_.begin(steps_ + 1);
  next_u_ = state_.now.s;
  next_u_.noalias() += system.B * state_.next_q;
  rhs_ = next_u_ - system.gap;
  if (solver_.statistics().limited > 0) rhs_ -= (u_ - system.gap).cwiseMax(0);
  next_force_.setZero();
  SolveResidual residual;
  if (!(rhs_.array() < 0).all()) {  // NaN included
    const SolveStatus status = solver_.solve(system.S, rhs_, next_force_);
    if (!has_forces(status)) return failure(status);
    residual = solver_.residual();
  }
  for (Eigen::Index i = 0; i < next_force_.size(); ++i) {
    const double lambda = next_force_(i);
    if (lambda != 0) next_u_ -= lambda * system.S.col(i);  // B q⁺ + s − R λ
  }
  if (!state_.step_under(next_force_)) return StepStatus::not_finite;
  return complete(static_cast<int>((next_force_.array() > 0).count()),
                  -next_force_.dot(next_u_ - u_) / options_.step, residual);
}

}  // namespace ricochet::contact
