// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/compliant_stepper.hpp"

namespace ricochet::contact {
namespace {

/// y += factor A x, for an x with few nonzero entries.
void add(double factor, const Eigen::MatrixXd& A, const Vector& x, Vector& y) noexcept {
  for (Eigen::Index j = 0; j < x.size(); ++j)
    if (x(j) != 0) y += (factor * x(j)) * A.col(j);
}

}  // namespace

CompliantStepper::CompliantStepper(const Model& model, const StepOptions& options)
    : Stepper(options, model.gap.size(), {.same_matrix = true, .max_pivots = options.max_pivots},
              conserves(model, options)),
      state_(model, options),
      flight_(*state_.system, options) {
  for (Vector* x : {&free_u_, &rhs_, &rest_, &rest_end_}) x->setZero(model.gap.size());
  state_.displacement(contact_.mean.end(), u_);
}

MeanForce::Trial CompliantStepper::attempt(const MeanWeights& weights) noexcept {
  const StepSystem& system = *state_.system;
  const MeanForce& mean = contact_.mean;
  const Eigen::MatrixXd& S = weights == backward_euler ? system.S : system.S_mean;
  next_force_ = weights.start * mean.end() + weights.before * mean.before();
  next_u_ = free_u_;
  add(-1, system.M, next_force_, next_u_);
  rhs_ = next_u_ - system.gap;
  if (solver().limited > 0) rhs_ -= (u_ - system.gap).cwiseMax(0);
  next_end_.setZero();
  residual_ = {};
  MeanForce::Trial out;
  if (!(rhs_.array() < 0).all()) {  // NaN included
    ComplementaritySolver& solver = solver_of(weights);
    out.status = solver.solve(S, rhs_, next_end_);
    if (!has_forces(out.status)) return out;
    residual_ = solver.residual();
  }
  add(-1, S, next_end_, next_u_);  // B q⁺ + s − R λ⁺
  next_force_ += weights.end * next_end_;
  if (!mean.is_conserving()) return out;
  rest_end_.setZero();
  add(1, system.R, next_end_, rest_end_);
  out.in_residual = next_end_.dot(rest_end_);
  out.removed =
      next_force_.dot(next_u_ - u_ + rest_end_ - rest_) + 0.5 * (mean.end().dot(rest_) - out.in_residual);
  out.opens = (next_end_.array() == 0).all();
  if (mean.begins() || out.opens)
    for (Eigen::Index j = 0; j < next_force_.size(); ++j)
      if (next_force_(j) != 0) out.in_modes += next_force_(j) * system.M.col(j).dot(next_force_);
  return out;
}

StepStatus CompliantStepper::step() noexcept {
  if (contact_.mean.begins())
    if (const int crossed = flight_.cross(state_, steps_); crossed > 0) {
      land(crossed);
      u_is_current_ = false;
      return StepStatus::ok;
    }
  displacement();
  state_.begin(steps_ + 1);
  free_u_ = state_.now.s;
  free_u_.noalias() += state_.system->B * state_.next_q;
  const SolveStatus status =
      contact_.mean.solve([this](const MeanWeights& weights) { return attempt(weights); });
  if (!has_forces(status)) return failure(status);
  if (!state_.step_under(next_force_, next_end_)) return StepStatus::not_finite;
  rest_.swap(rest_end_);
  return complete(static_cast<int>((next_end_.array() > 0).count()),
                  -next_force_.dot(next_u_ - u_) / options_.step, residual_);
}

const Vector& CompliantStepper::displacement() const noexcept {
  if (!u_is_current_) state_.displacement(contact_.mean.end(), u_);
  u_is_current_ = true;
  return u_;
}

}  // namespace ricochet::contact
