// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/event_stepper.hpp"

#include "base/archive.hpp"

namespace ricochet::contact {

EventStepper::EventStepper(std::shared_ptr<const Model> model, const StepOptions& options)
    : Stepper(options, model->points(), {.max_pivots = options.contact.max_pivots}, false),
      state_(std::move(model), options),
      problem_(state_, options),
      events_(*state_.system) {
  impulse_.setZero(points());
  state_.displacement(contact_.force, u_);
}

StepStatus EventStepper::step() noexcept {
  const double start = time(), end = static_cast<double>(steps_ + 1) * options_.step;
  const StepSystem& system = *state_.system;
  state_.next_q = state_.q;
  state_.next_v = state_.v;
  state_.now.s = state_.s;
  impulse_.setZero();
  if (steps_ == 0)
    events_.open_all();
  else
    events_.open(state_, u_);

  Work work;
  for (double from = start;;) {
    const double to = events_.first_closing(from, end, state_);
    if (from == start && to == end)
      state_.forcing.step(steps_ + 1, state_.now);
    else
      state_.forcing.interval(from, to, state_.now);
    const Work more = state_.forcing.advance(state_.now, system.load, state_.next_q, state_.next_v);
    work.damping += more.damping;
    work.forcing += more.forcing;
    next_u_ = state_.now.s;
    next_u_.noalias() += system.model->B * state_.next_q;
    const SolveStatus status = problem_.solve(state_, next_u_, law_.solver(), next_force_);
    if (!has_forces(status)) return failure(status);
    state_.strike(next_force_, work);
    impulse_ += next_force_;
    if (!(to < end)) break;
    events_.close(problem_.touching());
    from = to;
  }
  if (!state_.commit(work, 0)) return StepStatus::not_finite;
  next_force_ = impulse_ / options_.step;
  return complete(static_cast<int>((next_force_.array() > 0).count()), -work.contact / options_.step, {});
}

void EventStepper::archive(base::Archive& a) {
  archive_contact(a);
  a(state_, problem_, events_, impulse_);
}

}  // namespace ricochet::contact
