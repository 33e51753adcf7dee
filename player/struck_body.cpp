// SPDX-License-Identifier: BSD-2-Clause
#include "player/struck_body.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "contact/stepping/propagator.hpp"
#include "player/loops.hpp"

namespace ricochet::player {
namespace {

/// Gap of rows without a contact point [m], which therefore never close. It is small because the tolerance of
/// the solver is relative to the largest gap.
constexpr double absent = 1e-9;

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

StruckBody::StruckBody(const Instrument& instrument, int mallets, double step, double flight)
    : instrument_(&instrument),
      step_(step),
      flight_(flight),
      N_(instrument.omega.size()),
      P_(instrument.mallet_omega.size()),
      points_(most_points(instrument)),
      modes_(N_),
      count_(static_cast<std::size_t>(mallets), 0),
      has_bulges_(has_bulges(instrument)),
      law_(mallets * points_, {.same_matrix = true}, has_bulges_),
      mean_(mallets * points_, has_residual(instrument)) {
  const Eigen::Index modes = N_ + mallets * P_, rows = mallets * points_;
  for (Vector* x : {&contact_.S, &contact_.c, &contact_.rate, &stiffness_, &q_, &v_, &g_, &dq_, &push_})
    x->setZero(modes);
  for (Vector* x : {&free_.S, &free_.c, &free_.rate}) x->setZero(N_);
  for (Vector* x : {&u_, &end_}) x->setZero(rows);
  for (Eigen::Index i = 0; i < rows; ++i) law_.gap(i) = absent;
  rows_in_use_.reserve(static_cast<std::size_t>(rows));
  B_.setZero(rows, modes);
  for (Eigen::MatrixXd* x : {&M_, &R_, &S_, &S_mean_}) x->setZero(rows, rows);
  stiffness_.head(N_) = instrument.omega.cwiseAbs2();
  set_damping(1);
}

void StruckBody::set_damping(double factor) noexcept {
  for (Eigen::Index n = 0; n < N_; ++n) {
    const double omega = instrument_->omega(n), decay = factor * instrument_->decay(n);
    contact_.set(n, omega, decay, step_);
    free_.set(n, omega, decay, flight_);
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
  for (Eigen::Index i = 0; i < m; ++i) {
    law_.gap(row + i) = place.gap(i) + overlap;
    if (!has_bulges_) continue;
    if (const double yields = R_(row + i, row + i); yields > 0)
      law_.spring(row + i) = contact::PatchSpring::of(place.bulge(i), yields);
    else
      law_.gap(row + i) += place.bulge(i);
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
  for (Eigen::Index i = row; i < row + points_; ++i) {
    law_.gap(i) = absent;
    if (has_bulges_) law_.spring(i) = {};
  }
  for (Vector* x : {&u_, &law_.free}) x->segment(row, points_).setZero();
  renumber();
}

/// Counts the slots in use. Problems of another size or matrix begin anew.
void StruckBody::renumber() noexcept {
  slots_ = 0;
  for (std::size_t k = 0; k < count_.size(); ++k)
    if (count_[k] > 0) slots_ = static_cast<int>(k) + 1;
  modes_ = N_ + slots_ * P_;
  rows_ = slots_ * points_;
  rows_in_use_.resize(static_cast<std::size_t>(rows_));
  std::iota(rows_in_use_.begin(), rows_in_use_.end(), 0);
  law_.hold(rows_in_use_);
  law_.change_matrices();
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
  S_mean_ = contact::conserving_mean.end * M_ + R_;
  law_.change_matrices();
}

bool StruckBody::step() noexcept {
  const Eigen::Index n = modes_;
  auto next = push_.head(n);
  increment(stiffness_.data(), contact_.S.data(), contact_.c.data(), q_.data(), v_.data(), g_.data(),
            dq_.data(), n);
  next = q_.head(n) + dq_.head(n);
  for (int slot = 0; slot < slots_; ++slot)
    for (Eigen::Index i = slot * points_; i < slot * points_ + count_[slot]; ++i)
      law_.free(i) = dot(&B_(i, 0), next.data(), n);
  law_.start.head(rows_) = u_.head(rows_);
  const contact::StepTrial trial = law_.solve({.R = R_, .S = S_, .S_mean = S_mean_}, mean_, nullptr);
  const auto force = law_.force().head(rows_);

  force_ = force.sum();
  if (trial.status != contact::SolveStatus::solved || !std::isfinite(trial.removed + force_ + next.sum())) {
    rest();
    return false;
  }
  if (force_ != 0) {
    auto push = push_.head(n);
    push.setZero();
    for (Eigen::Index i = 0; i < rows_; ++i)
      if (force(i) != 0) push += force(i) * B_.row(i).head(n).transpose();
    dq_.head(n) -= contact_.c.head(n).cwiseProduct(push);
    g_.head(n) -= push;
  }
  advance(contact_.rate.data(), contact_.S.data(), g_.data(), dq_.data(), q_.data(), v_.data(), n);
  removed_ += trial.removed;
  residual_ = trial.in_residual;
  u_.head(rows_) = law_.u().head(rows_);
  end_.head(rows_) = law_.end().head(rows_);
  law_.accept(mean_, end_);
  return true;
}

void StruckBody::advance_in_flight() noexcept {
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
    double elastic = 0, rigid = 0, approach = 0;
    for (Eigen::Index n = 0; n < modes_; ++n) {
      const double b = B_(i, n);
      if (stiffness_(n) > 0) {
        elastic += b * b / stiffness_(n);
      } else {
        rigid += b * q_(n);
        approach += b * v_(n);
      }
    }
    if (approach > 0 || rigid + std::sqrt(elastic * energy) >= law_.gap(i)) return false;
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
  mean_.clear();
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
