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
    : Stepper(options, model), state_(model, options), flight_(*state_.system, options) {
  for (Vector* x : {&free_u_, &rhs_, &rest_, &rest_end_}) x->setZero(model.rows());
  for (const Model::FrictionPoint& point : model.friction)
    contacts_.push_back({point.point, point.tangential, 0});
  state_.displacement(contact_.mean.end(), u_);
}

MeanForce::Trial CompliantStepper::attempt(const MeanWeights& weights) noexcept {
  const StepSystem& system = *state_.system;
  const MeanForce& mean = contact_.mean;
  const Eigen::MatrixXd& S = weights == backward_euler ? system.S : system.S_mean;
  next_force_ = weights.start * mean.end() + weights.before * mean.before();
  next_u_ = free_u_;
  add(-1, system.M, next_force_, next_u_);
  const Eigen::Index m = points();
  const Slip& slip = contact_.slip;
  auto normal = rhs_.head(m);
  normal = next_u_.head(m) - system.gap;
  if (solver().limited > 0) normal -= (u_.head(m) - system.gap).cwiseMax(0);
  if (slip.any()) rhs_.tail(rhs_.size() - m) = (next_u_ - u_ - slip.belt()).tail(rhs_.size() - m);
  next_end_.setZero();
  residual_ = {};
  MeanForce::Trial out;
  const bool closed = !(normal.array() < 0).all();  // NaN included
  if (closed) {
    for (std::size_t f = 0; f < contacts_.size(); ++f) {
      FrictionContact& contact = contacts_[f];
      contact.coefficient =
          slip.coefficient(system.friction[f].law, static_cast<Eigen::Index>(f),
                           mean.end()(contact.normal) > 0, rhs_.segment<2>(contact.tangential).norm());
    }
    next_end_ = mean.end();
    ContactSolver& solver = solver_of(weights);
    out.status = solver.solve(S, rhs_, system.springs, contacts_, next_end_);
    if (!has_forces(out.status)) return out;
    residual_ = solver.residual();
    out.several = slip.any() && solver.friction().several();
  }
  add(-1, S, next_end_, next_u_);
  yield(system.springs, next_end_, next_u_);  // B q⁺ + s − R p⁺ − s(λ⁺)
  next_force_ += weights.end * next_end_;
  if (slip.any()) record_slip(closed ? &solver_of(weights).friction() : nullptr, out);
  if (!mean.is_conserving() && !slip.any()) return out;
  rest_end_.setZero();
  add(1, system.R, next_end_, rest_end_);
  out.in_residual = next_end_.dot(rest_end_);
  out.removed = next_force_.dot(next_u_ - u_ + rest_end_ - rest_) - out.belts +
                0.5 * (mean.end().dot(rest_) - out.in_residual);
  if (!system.springs.empty()) {
    const SpringWork springs = work_of(system.springs, mean.end(), next_end_, next_force_);
    out.in_residual += 2 * springs.stored;
    out.removed += springs.removed;
  }
  out.opens = (next_end_.array() == 0).all();
  if (mean.begins() || out.opens)
    for (Eigen::Index j = 0; j < next_force_.size(); ++j)
      if (next_force_(j) != 0) out.in_modes += next_force_(j) * system.M.col(j).dot(next_force_);
  return out;
}

/// Records the slip of a trial. @param solver  its solver; null if no point closed
void CompliantStepper::record_slip(const FrictionSolver* solver, MeanForce::Trial& trial) noexcept {
  Slip& slip = contact_.slip;
  slip.begin_trial();
  for (std::size_t f = 0; f < contacts_.size(); ++f) {
    const int t = contacts_[f].tangential;
    const Eigen::Vector2d d = (next_u_ - u_ - slip.belt()).segment<2>(t);
    trial.heat +=
        slip.record(static_cast<Eigen::Index>(f),
                    solver != nullptr ? solver->states()[f] : ContactState::open, &next_force_(t), d.data());
  }
  trial.cools = slip.cools();
  trial.belts = next_force_.dot(slip.belt());
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
  contact_.slip.begin(*state_.system, steps_ + 1);
  free_u_ = state_.now.s;
  free_u_.noalias() += state_.system->B * state_.next_q;
  const MeanForce::Trial trial =
      contact_.mean.solve([this](const MeanWeights& weights) { return attempt(weights); });
  if (!has_forces(trial.status)) return failure(trial.status);
  const Work at_points{
      .contact = trial.removed + trial.belts + 0.5 * trial.in_residual - state_.energy().residual,
      .friction = trial.heat,
      .belts = trial.belts};
  if (!state_.step_under(next_force_, next_end_, contact_.slip.any() ? &at_points : nullptr))
    return StepStatus::not_finite;
  rest_.swap(rest_end_);
  if (trial.several) ++contact_.ambiguous;
  const Eigen::Index m = points();
  return complete(static_cast<int>((next_end_.head(m).array() > 0).count()),
                  -next_force_.head(m).dot((next_u_ - u_).head(m)) / options_.step, residual_);
}

const Vector& CompliantStepper::displacement() const noexcept {
  if (!u_is_current_) state_.displacement(contact_.mean.end(), u_);
  u_is_current_ = true;
  return u_;
}

}  // namespace ricochet::contact
