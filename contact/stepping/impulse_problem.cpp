// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/impulse_problem.hpp"

#include <cmath>

namespace ricochet::contact {
namespace {

/// Share of the mean diagonal of A that is added to it. If there are more points than modes, A is singular
/// and determines only Bᵀ P; this term selects the P of least norm and leaves 1e-12 of the approach velocity.
constexpr double least_norm = 1e-12;

std::shared_ptr<const Eigen::MatrixXd> admittance_of(const StepSystem& system, const StepOptions& options) {
  const Matrix& B = system.model->B;
  auto out = std::make_shared<Eigen::MatrixXd>();
  if (options.contact.admittance == Admittance::jump)
    *out = B * B.transpose();
  else
    *out = B * (system.b / options.step).asDiagonal() * B.transpose();
  if (out->size() > 0) out->diagonal().array() += least_norm * out->diagonal().mean();
  return out;
}

}  // namespace

double touching_margin(const StepSystem& system, Eigen::Index i, double size, double s) noexcept {
  // u_i is a sum of N products, so its round-off is a small multiple of ε |B_i| |q|.
  return 1e-13 * (size * system.norm(i) + std::abs(system.gap(i)) + std::abs(s));
}

ImpulseProblem::ImpulseProblem(const ModalState& state, const StepOptions& options)
    : options_(options),
      next_(state.now),
      A_(admittance_of(*state.system, options)),
      sub_(state.system->gap.size()) {
  const Eigen::Index m = state.system->gap.size();
  for (Vector* x : {&rhs_, &solution_}) x->setZero(m);
  touching_.reserve(m);
}

SolveStatus ImpulseProblem::solve(ModalState& state, const Vector& u, ContactSolver& solver,
                                  Vector& impulse) noexcept {
  const StepSystem& system = *state.system;
  const ForcedResponse::Interval& now = state.now;
  impulse.setZero();
  touching_.clear();
  const double size = state.next_q.norm();
  for (Eigen::Index i = 0; i < system.gap.size(); ++i)
    if (!(u(i) < system.gap(i) - touching_margin(system, i, size, now.s(i))))
      touching_.push_back(static_cast<int>(i));
  if (touching_.empty()) return SolveStatus::solved;

  // v̂ = B x + ṡ: the velocity at t_k, or its mean over the next step
  const Vector* x = &state.next_v;
  const Vector* rate = &now.rate;
  if (options_.contact.admittance == Admittance::difference) {
    next_.s = now.s;
    if (state.forcing.any()) state.forcing.interval(now.to, now.to + options_.step, next_);
    Vector& moved = state.free_motion(state.next_q, state.next_v, next_);
    moved /= options_.step;
    next_.s = (next_.s - now.s) / options_.step;
    x = &moved;
    rate = &next_.s;
  }
  const Eigen::Index n = touching_.size();
  auto sub = sub_.begin(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const int i = touching_[j];
    rhs_(j) = (1 + options_.contact.restitution) * (system.model->B.row(i).dot(*x) + (*rate)(i));
    for (Eigen::Index l = 0; l < n; ++l) sub(l, j) = (*A_)(touching_[l], i);
  }
  const SolveStatus status = solver.solve(sub, rhs_.head(n), solution_.head(n));
  for (Eigen::Index j = 0; j < n; ++j) impulse(touching_[j]) = solution_(j);
  return status;
}

}  // namespace ricochet::contact
