// SPDX-License-Identifier: BSD-2-Clause
#include "player/struck_body.hpp"

#include <algorithm>
#include <cmath>

#include "contact/stepping/propagator.hpp"
#include "player/loops.hpp"

namespace ricochet::player {
namespace {

using contact::backward_euler;
using contact::conserving_mean;
using contact::MeanForce;
using contact::MeanWeights;
using contact::SolveStatus;

/// Gap of rows without a contact point [m], which therefore never close. It is small because the tolerance of
/// the solver is relative to the largest gap.
constexpr double absent = 1e-9;

constexpr contact::SolveOptions same_matrix{.same_matrix = true};

Eigen::Index most_points(const Instrument& instrument) {
  Eigen::Index most = 0;
  for (const Place& place : instrument.places) most = std::max(most, place.gap.size());
  return most;
}

bool has_bulges(const Instrument& instrument) {
  bool any = false;
  for (const Place& place : instrument.places) any = any || !place.bulge.isZero(0);
  return any;
}

bool has_residual(const Instrument& instrument) {
  bool any = false;
  for (const Place& place : instrument.places) any = any || !place.flexibility.isZero(0);
  for (const Mallet& mallet : instrument.mallets) any = any || mallet.layer > 0;
  return any;
}

}  // namespace

void StruckBody::Propagator::set(Eigen::Index n, double omega, double decay, double time) noexcept {
  const contact::ModeResponse response = contact::mode_response(omega, decay, time);
  S(n) = response.S;
  c(n) = response.c;
  rate(n) = response.rate;
}

StruckBody::StruckBody(const Instrument& instrument, int mallets, double step, double glide)
    : instrument_(&instrument),
      step_(step),
      glide_(glide),
      N_(instrument.omega.size()),
      P_(instrument.mallet_omega.size()),
      points_(most_points(instrument)),
      modes_(N_),
      count_(static_cast<std::size_t>(mallets), 0),
      springs_(static_cast<std::size_t>(has_bulges(instrument) ? mallets * points_ : 0)),
      solver_(static_cast<int>(mallets * points_), same_matrix, false, FrictionLaw::coulomb,
              !springs_.empty()),
      mean_solver_(static_cast<int>(mallets * points_), same_matrix, false, FrictionLaw::coulomb,
                   !springs_.empty()),
      mean_(mallets * points_, has_residual(instrument)) {
  const Eigen::Index modes = N_ + mallets * P_, rows = mallets * points_;
  for (Vector* x : {&contact_.S, &contact_.c, &contact_.rate, &stiffness_, &q_, &v_, &g_, &dq_, &push_})
    x->setZero(modes);
  for (Vector* x : {&free_.S, &free_.c, &free_.rate}) x->setZero(N_);
  for (Vector* x : {&gap_, &u_, &free_u_, &rhs_, &rest_, &next_rest_, &next_u_, &next_end_, &next_force_})
    x->setZero(rows);
  gap_.setConstant(absent);
  B_.setZero(rows, modes);
  for (Eigen::MatrixXd* x : {&M_, &R_, &S_, &S_mean_}) x->setZero(rows, rows);
  stiffness_.head(N_) = instrument.omega.cwiseAbs2();
  set_damping(1);
}

void StruckBody::set_damping(double factor) noexcept {
  for (Eigen::Index n = 0; n < N_; ++n) {
    const double omega = instrument_->omega(n), decay = factor * instrument_->decay(n);
    contact_.set(n, omega, decay, step_);
    free_.set(n, omega, decay, glide_);
  }
  for (int slot = 0; slot < slots_; ++slot)
    if (holds(slot)) couple(slot);
}

/// A mallet μ times as dense: φ/√μ, ω/√μ, q̇ √μ at the same speed, and the same flexibility.
void StruckBody::bring(int slot, const Place& place, int mallet, double speed) noexcept {
  const Mallet& kind = instrument_->mallets[static_cast<std::size_t>(mallet)];
  const double root = std::sqrt(kind.mass);
  take(slot);
  if (alone())
    for (Eigen::Index n = 0; n < N_; ++n)
      if (stiffness_(n) == 0) q_(n) = v_(n) = 0;
  count_[slot] = place.gap.size();
  renumber();

  const Eigen::Index first = N_ + slot * P_, row = slot * points_, m = place.gap.size();
  for (Eigen::Index n = 0; n < P_; ++n) {
    const double omega = instrument_->mallet_omega(n) / root;
    stiffness_(first + n) = omega * omega;
    contact_.set(first + n, omega, instrument_->mallet_decay(n) / root, step_);
  }
  v_.segment(first, P_) = (speed * root) * place.rate;
  B_.block(row, 0, m, N_) = place.B.leftCols(N_);
  B_.block(row, first, m, P_) = place.B.rightCols(P_) / root;
  R_.block(row, row, m, m) = place.flexibility;
  for (Eigen::Index i = 0; i < m; ++i) R_(row + i, row + i) += kind.layer / place.area(i);

  double overlap = 0;
  for (Eigen::Index i = 0; i < m; ++i) {
    u_(row + i) = B_.row(row + i).head(modes_).dot(q_.head(modes_));
    overlap = std::max(overlap, u_(row + i) - place.gap(i));
  }
  gap_.segment(row, m) = place.gap.array() + overlap;
  for (Eigen::Index i = 0; i < m && !springs_.empty(); ++i) {
    const double yields = R_(row + i, row + i);
    if (yields > 0)
      springs_[row + i] = contact::PatchSpring::of(place.bulge(i), yields);
    else
      gap_(row + i) += place.bulge(i);
  }
  couple(slot);
}

void StruckBody::take(int slot) noexcept {
  if (!holds(slot)) return;
  const Eigen::Index first = N_ + slot * P_, row = slot * points_;
  count_[slot] = 0;
  for (Vector* x : {&q_, &v_, &stiffness_, &contact_.S, &contact_.c, &contact_.rate})
    x->segment(first, P_).setZero();
  B_.middleRows(row, points_).setZero();
  for (Eigen::MatrixXd* x : {&M_, &R_, &S_, &S_mean_}) {
    x->middleRows(row, points_).setZero();
    x->middleCols(row, points_).setZero();
  }
  gap_.segment(row, points_).setConstant(absent);
  if (!springs_.empty()) std::fill_n(springs_.begin() + row, points_, contact::PatchSpring{});
  for (Vector* x : {&u_, &free_u_, &rest_, &next_end_, &next_force_, &next_u_, &next_rest_})
    x->segment(row, points_).setZero();
  renumber();
}

/// Counts the slots in use. Problems of another size or matrix begin anew.
void StruckBody::renumber() noexcept {
  slots_ = 0;
  for (std::size_t k = 0; k < count_.size(); ++k)
    if (count_[k] > 0) slots_ = static_cast<int>(k) + 1;
  modes_ = N_ + slots_ * P_;
  rows_ = slots_ * points_;
  solver_.reset();
  mean_solver_.reset();
}

/// Computes the rows and columns of a mallet in M and S.
void StruckBody::couple(int slot) noexcept {
  const Eigen::Index row = slot * points_;
  for (Eigen::Index i = row; i < row + count_[slot]; ++i) {
    push_.head(modes_) = B_.row(i).head(modes_).transpose().cwiseProduct(contact_.c.head(modes_));
    for (Eigen::Index j = 0; j < rows_; ++j)
      M_(i, j) = M_(j, i) = B_.row(j).head(modes_).dot(push_.head(modes_));
  }
  S_ = M_ + R_;
  S_mean_ = conserving_mean.end * M_ + R_;
  solver_.reset();
  mean_solver_.reset();
}

MeanForce::Trial StruckBody::attempt(const MeanWeights& weights) noexcept {
  const Eigen::Index n = rows_;
  const bool euler = weights == backward_euler;
  const std::span<const contact::PatchSpring> springs(springs_.data(),
                                                      springs_.empty() ? 0 : static_cast<std::size_t>(n));
  const Eigen::MatrixXd& S = euler ? S_ : S_mean_;
  auto force = next_force_.head(n), end = next_end_.head(n), u = next_u_.head(n), rest = next_rest_.head(n);
  const auto now = mean_.end().head(n);
  const auto add = [n](double factor, const Eigen::MatrixXd& A, const auto& x, auto& y) {
    for (Eigen::Index j = 0; j < n; ++j)
      if (x(j) != 0) y += (factor * x(j)) * A.col(j).head(n);
  };
  force = weights.start * now + weights.before * mean_.before().head(n);
  u = free_u_.head(n);
  add(-1, M_, force, u);
  rhs_.head(n) = u - gap_.head(n);
  end.setZero();
  MeanForce::Trial out;
  if (!(rhs_.head(n).array() < 0).all()) {  // NaN included
    end = now;
    out.status =
        (euler ? solver_ : mean_solver_).solve(S.topLeftCorner(n, n), rhs_.head(n), springs, {}, end);
    if (out.status != SolveStatus::solved) return out;
  }
  add(-1, S, end, u);
  contact::yield(springs, end, u);  // B q⁺ − R λ⁺ − s(λ⁺)
  force += weights.end * end;
  rest.setZero();
  add(1, R_, end, rest);
  out.in_residual = end.dot(rest);
  out.removed =
      force.dot(u - u_.head(n) + rest - rest_.head(n)) + 0.5 * (now.dot(rest_.head(n)) - out.in_residual);
  if (!springs.empty()) {
    const contact::SpringWork work = contact::work_of(springs, now, end, force);
    out.in_residual += 2 * work.stored;
    out.removed += work.removed;
  }
  out.opens = (end.array() == 0).all();
  if (mean_.begins() || out.opens)
    for (Eigen::Index j = 0; j < n; ++j)
      if (force(j) != 0) out.in_modes += force(j) * M_.col(j).head(n).dot(force);
  return out;
}

bool StruckBody::step() noexcept {
  const Eigen::Index n = modes_;
  auto next = push_.head(n);
  increment(stiffness_.data(), contact_.S.data(), contact_.c.data(), q_.data(), v_.data(), g_.data(),
            dq_.data(), n);
  next = q_.head(n) + dq_.head(n);
  for (int slot = 0; slot < slots_; ++slot)
    for (Eigen::Index i = slot * points_; i < slot * points_ + count_[slot]; ++i)
      free_u_(i) = dot(&B_(i, 0), next.data(), n);
  const MeanForce::Trial trial = mean_.solve([this](const MeanWeights& weights) { return attempt(weights); });

  force_ = next_force_.head(rows_).sum();
  if (trial.status != SolveStatus::solved || !std::isfinite(trial.removed + force_ + next.sum())) {
    rest();
    return false;
  }
  if (force_ != 0) {
    auto push = push_.head(n);
    push.setZero();
    for (Eigen::Index i = 0; i < rows_; ++i)
      if (next_force_(i) != 0) push += next_force_(i) * B_.row(i).head(n).transpose();
    dq_.head(n) -= contact_.c.head(n).cwiseProduct(push);
    g_.head(n) -= push;
  }
  advance(contact_.rate.data(), contact_.S.data(), g_.data(), dq_.data(), q_.data(), v_.data(), n);
  removed_ += trial.removed;
  residual_ = 0.5 * trial.in_residual;
  rest_.swap(next_rest_);
  u_.swap(next_u_);
  mean_.advance(next_end_);
  return true;
}

void StruckBody::glide() noexcept {
  fly(stiffness_.data(), free_.S.data(), free_.c.data(), free_.rate.data(), q_.data(), v_.data(), N_);
  force_ = 0;
}

bool StruckBody::touches(int slot) const noexcept {
  const Eigen::Index row = slot * points_;
  return (mean_.end().segment(row, points_).array() > 0).any() ||
         (mean_.before().segment(row, points_).array() > 0).any();
}

/// |Σ B q| ≤ (Σ B²/ω²)^½ (Σ ω²q² + q̇²)^½ over the elastic modes, whose energy does not grow in free flight.
bool StruckBody::recedes(int slot) const noexcept {
  if (touches(slot)) return false;
  double energy = 0;
  for (Eigen::Index n = 0; n < modes_; ++n)
    if (stiffness_(n) > 0) energy += stiffness_(n) * q_(n) * q_(n) + v_(n) * v_(n);
  for (Eigen::Index i = slot * points_; i < slot * points_ + count_[slot]; ++i) {
    double reach = 0, rigid = 0, approach = 0;
    for (Eigen::Index n = 0; n < modes_; ++n) {
      const double b = B_(i, n);
      if (stiffness_(n) > 0) {
        reach += b * b / stiffness_(n);
      } else {
        rigid += b * q_(n);
        approach += b * v_(n);
      }
    }
    if (approach > 0 || rigid + std::sqrt(reach * energy) >= gap_(i)) return false;
  }
  return true;
}

bool StruckBody::rest_below(double least) noexcept {
  bool all = true;
  for (Eigen::Index n = 0; n < N_; ++n) {
    if (stiffness_(n) * q_(n) * q_(n) + v_(n) * v_(n) < 2 * least)
      v_(n) = q_(n) = 0;
    else
      all = false;
  }
  return all;
}

void StruckBody::rest() noexcept {
  for (std::size_t slot = 0; slot < count_.size(); ++slot) take(static_cast<int>(slot));
  q_.setZero();
  v_.setZero();
  next_end_.setZero();
  mean_.advance(next_end_);  // twice: no force at the last two instants
  mean_.advance(next_end_);
  force_ = residual_ = 0;
}

Energies StruckBody::energies() const noexcept {
  const auto of = [this](Eigen::Index first, Eigen::Index count) {
    const auto q = q_.segment(first, count), v = v_.segment(first, count);
    return 0.5 * (v.squaredNorm() + stiffness_.segment(first, count).dot(q.cwiseAbs2()));
  };
  return {.body = of(0, N_), .mallets = of(N_, modes_ - N_), .residual = residual_, .contact = removed_};
}

}  // namespace ricochet::player
