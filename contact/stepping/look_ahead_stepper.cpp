// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/look_ahead_stepper.hpp"

#include <utility>

#include "base/archive.hpp"

namespace ricochet::contact {
namespace {

/// The cost of the near history grows with the block and with the square of the rows; that of the far
/// history grows only with the modes. Longer blocks therefore pay if there are few rows.
constexpr Eigen::Index few_rows = 64;
constexpr int long_block = 24, short_block = 8;

}  // namespace

int look_ahead_length(const StepOptions& options, Eigen::Index rows) {
  return options.block > 0 ? options.block : rows <= few_rows ? long_block : short_block;
}

template <class T>
LookAheadStepper<T>::LookAheadStepper(std::shared_ptr<const Model> model, const StepOptions& options)
    : Stepper(options, *model),
      state_(std::move(model), options),
      block_(std::make_shared<const BlockSystem<T>>(
                 state_.system, look_ahead_length(options, state_.system->model->rows()), options.step),
             state_.forcing.any()),
      flight_(*state_.system, options),
      known_(contact_) {
  state_.displacement(contact_.mean.end(), u_);
}

template <class T>
StepStatus LookAheadStepper<T>::step() noexcept {
  if (block_.over()) {
    const int crossed = contact_.mean.begins() ? flight_.cross(state_, steps_) : 0;
    flew_ = crossed > 0;
    if (flew_) {
      block_.take_back();  // u at its end is no longer that of the state
      land(crossed);
      known_ = contact_;
      u_is_current_ = false;
      return StepStatus::ok;
    }
    start_block();
  }
  Slip* const slip = contact_.slip.any() ? &contact_.slip : nullptr;
  if (slip != nullptr) slip->begin(state_.system->model->belts, steps_ + 1);
  const StepTrial trial = block_.step(law_, contact_.mean, slip, next_force_, next_end_);
  if (!has_forces(trial.status)) return failure(trial.status);
  u_is_current_ = false;
  if (trial.several) ++contact_.ambiguous;
  if (block_.forcing().forced) {
    state_.begin(steps_ + 1);
    const Work at_points = work_of(trial, state_.energy().residual);
    if (!state_.step_under(next_force_, trial.in_residual, slip != nullptr ? &at_points : nullptr)) {
      block_.take_back();
      return StepStatus::not_finite;
    }
  } else {
    ++pending_;
    at_points_.contact += trial.removed + trial.belts;
    at_points_.friction += trial.heat;
    at_points_.belts += trial.belts;
    if (block_.begins() && block_.forcing().jumps)
      at_points_.forcing = next_force_.dot(state_.forcing.piece().s - state_.s);
    if (options_.every_state || block_.over())
      if (const StepStatus status = move_state(); status != StepStatus::ok) return status;
  }
  end_contact(block_.touching(), -block_.work() / options_.step, trial.violation);
  ++steps_;
  if (!options_.every_state && pending_ == 0) known_ = contact_;
  return StepStatus::ok;
}

template <class T>
void LookAheadStepper<T>::start_block() noexcept {
  const double from = time(), to = static_cast<double>(steps_ + block_.length()) * options_.step;
  block_.forcing().set(state_.forcing.piece(from), to, state_.system->load, state_.s);
  for (int l = 1; block_.forcing().forced && l <= block_.length(); ++l) {
    ForcedResponse::Interval& now = state_.now;
    state_.forcing.forced_step(steps_ + l, now);
    block_.forcing().set_response(l, now.q, now.v, now.s);
  }
  block_.start(state_.q, state_.v, contact_.force, law_, contact_.mean);
}

/// Advances q, q̇ and the ledger through the pending steps; steps_ does not yet include the last of them. If
/// this fails, all pending steps are undone.
template <class T>
StepStatus LookAheadStepper<T>::move_state() noexcept {
  const simd::Sums sums = block_.advance(keeps_rates_);
  const double residual = block_.energy_in_residual();
  Work work{.damping = sums.damping, .contact = sums.contact};
  if (const ForcedResponse::Piece& piece = state_.forcing.piece(); piece.loaded)
    work.forcing = piece.applied.dot(block_.q() - state_.q);
  work.forcing += at_points_.forcing;
  work.contact += at_points_.forcing;  // part of the work at points, with friction
  if (contact_.slip.any()) {
    work.contact = at_points_.contact + residual - state_.energy().residual;
    work.friction = at_points_.friction;
    work.belts = at_points_.belts;
  }
  at_points_ = {};
  const bool finite = state_.ledger.close(
      {.kinetic = sums.kinetic, .strain = sums.strain, .residual = residual, .loads = sums.loads}, work);
  if (finite) {
    block_.copy_state(state_.q, state_.v);
    if (block_.forcing().jumps) state_.s = state_.forcing.piece().s;
  } else {
    block_.take_back();
    if (pending_ > 1) {
      steps_ -= pending_ - 1;
      contact_ = known_;
    }
  }
  pending_ = 0;
  return finite ? StepStatus::ok : StepStatus::not_finite;
}

template <class T>
StepStatus LookAheadStepper<T>::catch_up() noexcept {
  if (pending_ == 0) return StepStatus::ok;
  --steps_;
  const StepStatus status = move_state();
  if (status == StepStatus::ok) ++steps_;
  u_is_current_ = false;
  known_ = contact_;
  return status;
}

template <class T>
void LookAheadStepper<T>::keep(bool every_state, bool rates) noexcept {
  if (pending_ == 0) known_ = contact_;
  options_.every_state = every_state;
  keeps_rates_ = rates;
}

template <class T>
const double* LookAheadStepper<T>::rate(int back) const noexcept {
  return block_.forcing().forced || flew_ ? state_.v.data() : block_.rate(block_.advanced() - back);
}

template <class T>
const Vector& LookAheadStepper<T>::displacement() const noexcept {
  if (!u_is_current_) state_.displacement((pending_ > 0 ? known_ : contact_).mean.end(), u_);
  u_is_current_ = true;
  return u_;
}

/// Discards the rest of the block, which knew nothing of the force.
template <class T>
bool LookAheadStepper<T>::push_at(int body, const BodyPlace& place, const Eigen::Vector3d& force) noexcept {
  const PushStatus status = state_.push_at(body, place, force);
  if (status == PushStatus::changed) block_.take_back();
  return status != PushStatus::refused;
}

template <class T>
void LookAheadStepper<T>::archive(base::Archive& a) {
  archive_contact(a);
  a(state_, block_, flew_, u_is_current_, at_points_, pending_, known_);
}

template class LookAheadStepper<double>;
template class LookAheadStepper<float>;

}  // namespace ricochet::contact
