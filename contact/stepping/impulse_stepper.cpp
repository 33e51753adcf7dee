// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/impulse_stepper.hpp"

#include "base/archive.hpp"

namespace ricochet::contact {

ImpulseStepper::ImpulseStepper(std::shared_ptr<const Model> model, const StepOptions& options)
    : Stepper(options, model->points(), {.max_pivots = options.contact.max_pivots}, false),
      state_(std::move(model), options),
      problem_(state_, options) {
  state_.displacement(contact_.force, u_);
}

StepStatus ImpulseStepper::step() noexcept {
  state_.begin(steps_ + 1);
  Work work = state_.free_step();
  next_u_ = state_.now.s;
  next_u_.noalias() += state_.system->model->B * state_.next_q;
  const SolveStatus status = problem_.solve(state_, next_u_, law_.solver(), next_force_);
  if (!has_forces(status)) return failure(status);
  const int active = state_.strike(next_force_, work);
  if (!state_.commit(work, 0)) return StepStatus::not_finite;
  next_force_ /= options_.step;
  return complete(active, -work.contact / options_.step,
                  problem_.touching().empty() ? SolveResidual{} : law_.solver().residual());
}

void ImpulseStepper::archive(base::Archive& a) {
  archive_contact(a);
  a(state_, problem_);
}

}  // namespace ricochet::contact
