// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/forced_response.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ricochet::contact {

ForcedResponse::ForcedResponse(const Model& model, double step)
    : step_(step),
      omega_(model.omega),
      decay_(model.decay),
      gravity_(model.load),
      s_(model.turns ? Vector() : model.static_displacement),
      forcing_(model.forcing) {
  const Eigen::Index N = model.omega.size();
  for (Model::Forcing& one : forcing_) {
    if (model.turns) one.displacement.resize(0);  // points have no rows of their own
    for (const int n : model.folded.modes)
      if (const Eigen::Index i = n - one.first_mode; i >= 0 && i < one.lift.size()) one.lift(i) = 0;
  }
  for (Eigen::Index n = 0; n < N; ++n) whole_.push_back(mode_step(omega_(n), decay_(n), step));
  softness_ = (omega_.array() > 0).select(omega_.array().square().inverse(), 0.0);
  rest_ = s_;
  if (!model.turns) rest_ += model.B * softness_.cwiseProduct(model.load);
  for (const Model::Forcing& one : forcing_) {
    if (model.turns) {
      rests_.emplace_back();
      continue;
    }
    const auto B = model.B.middleCols(one.first_mode, one.force.size());
    const auto soft = softness_.segment(one.first_mode, one.force.size()),
               decay = decay_.segment(one.first_mode, one.force.size());
    const Vector flexed = soft.cwiseProduct(one.force);
    rests_.push_back(
        {one.displacement + B * flexed, B * (2 * decay.cwiseProduct(soft)).cwiseProduct(flexed)});
  }
  forcing_.push_back({.name = {},
                      .support = false,
                      .history = dead_load,
                      .force = Vector::Zero(N),
                      .lift = Vector::Zero(N),
                      .displacement = Vector::Zero(s_.size()),
                      .displacement_a = {}});
  rests_.push_back({Vector::Zero(s_.size()), Vector::Zero(s_.size())});
  for (Vector* x : {&value_, &slope_, &lift_, &piece_.applied, &piece_.slope, &piece_.rest_q, &piece_.rest_v})
    x->setZero(N);
  piece_.load = gravity_;
  piece_.s = s_;
  piece_.rest = rest_;
  piece_.drift.setZero(s_.size());
  piece(0);
}

ForcedResponse::Interval ForcedResponse::start() {
  Interval out;
  for (Vector* x : {&out.q, &out.v, &out.lift}) x->setZero(omega_.size());
  out.s = s_;
  out.rate = Vector::Zero(s_.size());
  fill_unless_steady(out);
  return out;
}

void ForcedResponse::turn(std::size_t load, const Vector& force) noexcept {
  forcing_[load].force = force;
  piece_.at = std::numeric_limits<double>::quiet_NaN();
}

void ForcedResponse::push(const Model& model, const Vector& force, const Vector& displacement) noexcept {
  pushes_ = true;
  forcing_.back().force = force;
  piece_.at = std::numeric_limits<double>::quiet_NaN();
  if (model.turns) return;
  forcing_.back().displacement = displacement;
  value_ = softness_.cwiseProduct(force);
  rests_.back().at = displacement;
  rests_.back().at.noalias() += model.B * value_;
}

const ForcedResponse::Piece& ForcedResponse::piece(double t) noexcept {
  Piece& p = piece_;
  if (!any() || t == p.at || (p.steady && t > p.at && t < p.to)) return p;
  p.at = t;
  p.to = next_knot(t);
  force(t, p.applied, p.slope);
  p.load = gravity_ + p.applied;
  p.loaded = !p.applied.isZero(0);
  p.rest_v = softness_.cwiseProduct(p.slope);
  p.rest_q = softness_.cwiseProduct(p.applied - 2 * decay_.cwiseProduct(p.rest_v));
  p.steady = true;
  p.s = s_;
  p.rest = rest_;
  p.drift.setZero();
  for (std::size_t d = 0; d < acting().size(); ++d) {
    const double value = forcing_[d].history.at(t), slope = forcing_[d].history.slope(t);
    p.steady = p.steady && slope == 0;
    p.s += value * forcing_[d].displacement;
    p.rest += value * rests_[d].at - slope * rests_[d].lag;
    p.drift += slope * rests_[d].at;
  }
  return p;
}

void ForcedResponse::set_times(std::int64_t k, Interval& out) const noexcept {
  out.from = static_cast<double>(k - 1) * step_;
  out.to = static_cast<double>(k) * step_;
  out.whole = true;
}

void ForcedResponse::step(std::int64_t k, Interval& out) noexcept {
  set_times(k, out);
  fill_unless_steady(out);
}

void ForcedResponse::forced_step(std::int64_t k, Interval& out) noexcept {
  set_times(k, out);
  fill(out);
}

void ForcedResponse::interval(double from, double to, Interval& out) noexcept {
  out.from = from;
  out.to = to;
  out.whole = to == from + step_;
  fill_unless_steady(out);
}

void ForcedResponse::fill_unless_steady(Interval& out) noexcept {
  if (const Piece& p = piece(out.from); !p.steady || p.to <= out.to) {
    fill(out);
    return;
  }
  out.s = piece_.s;
  if (out.forced) {
    out.rate.setZero();
    out.lift.setZero();
  }
  out.forced = false;
}

/// Response from rest, where ℓ is the time from a knot to the end:
///   loads:     q = F [h c + h' r] at the start, and F [J c(ℓ) + K r(ℓ)] from each knot; q̇ likewise by S, c
///   supports:  q = −Γ K S(ℓ), q̇ = −Γ K S'(ℓ) from each knot
void ForcedResponse::fill(Interval& out) noexcept {
  out.forced = true;
  points(out.to, out.s, out.rate);
  for (Vector* x : {&out.q, &out.v, &out.lift}) x->setZero();
  for (const Model::Forcing& forcing : acting()) {
    const History& h = forcing.history;
    if (forcing.support) {
      out.lift.segment(forcing.first_mode, forcing.lift.size()) += h.slope(out.to) * forcing.lift;
    } else {
      const double value = h.at(out.from), slope = h.slope(out.from);
      for (Eigen::Index i = 0; i < forcing.force.size(); ++i) {
        const Eigen::Index n = forcing.first_mode + i;
        ModeResponse m = whole_[n];
        if (!out.whole) m = mode_response(omega_(n), decay_(n), out.to - out.from);
        out.q(n) += forcing.force(i) * (value * m.c + slope * m.r);
        out.v(n) += forcing.force(i) * (value * m.S + slope * m.c);
      }
    }
    for (std::size_t j = h.passed(out.from), end = h.passed(out.to); j < end; ++j) {
      const double left = out.to - h.time[j], jump = h.jump(j), kink = h.kink(j);
      for (Eigen::Index i = 0; i < forcing.force.size(); ++i) {
        const Eigen::Index n = forcing.first_mode + i;
        const ModeResponse m = mode_response(omega_(n), decay_(n), left);
        out.q(n) += forcing.force(i) * (jump * m.c + kink * m.r) - forcing.lift(i) * kink * m.S;
        out.v(n) += forcing.force(i) * (jump * m.S + kink * m.c) - forcing.lift(i) * kink * m.rate;
      }
    }
  }
}

void ForcedResponse::force(double t, Vector& value, Vector& slope) const noexcept {
  value.setZero();
  slope.setZero();
  for (const Model::Forcing& forcing : acting())
    if (!forcing.support) {
      value.segment(forcing.first_mode, forcing.lift.size()) += forcing.history.at(t) * forcing.force;
      slope.segment(forcing.first_mode, forcing.lift.size()) += forcing.history.slope(t) * forcing.force;
    }
}

void ForcedResponse::points(double t, Vector& s, Vector& rate) const noexcept {
  s = s_;
  rate.setZero();
  for (const Model::Forcing& forcing : acting()) {
    s += forcing.history.at(t) * forcing.displacement;
    rate += forcing.history.slope(t) * forcing.displacement;
  }
}

void ForcedResponse::free_flight(double time, const Vector& force, const Vector& slope, const Vector& q,
                                 const Vector& v, Vector& then_q, Vector& then_v) const noexcept {
  for (Eigen::Index n = 0; n < q.size(); ++n) {
    const ModeResponse m = mode_response(omega_(n), decay_(n), time);
    const double g = force(n) - omega_(n) * omega_(n) * q(n);
    then_q(n) = q(n) + m.S * v(n) + m.c * g + m.r * slope(n);
    then_v(n) = m.rate * v(n) + m.S * g + m.c * slope(n);
  }
}

void ForcedResponse::bound(double time, const Vector& force, const Vector& slope, const Vector& q,
                           const Vector& v, Vector& acceleration) const noexcept {
  for (Eigen::Index n = 0; n < q.size(); ++n)
    acceleration(n) =
        std::hypot(force(n) - 2 * decay_(n) * v(n) - omega_(n) * omega_(n) * q(n), omega_(n) * v(n)) +
        std::abs(slope(n)) * time;
}

double ForcedResponse::next_knot(double t) const noexcept {
  double next = std::numeric_limits<double>::infinity();
  for (const Model::Forcing& forcing : acting()) {
    const std::size_t knot = forcing.history.passed(t);
    if (knot < forcing.history.time.size()) next = std::min(next, forcing.history.time[knot]);
  }
  return next;
}

void ForcedResponse::velocity_jump(double knot, Vector& v) const noexcept {
  for (const Model::Forcing& forcing : acting()) {
    if (!forcing.support) continue;
    const std::size_t next = forcing.history.passed(knot);
    if (next > 0 && forcing.history.time[next - 1] == knot)
      v.segment(forcing.first_mode, forcing.lift.size()) -= forcing.history.kink(next - 1) * forcing.lift;
  }
}

/// For each piece between knots, of length ℓ, with g = f + F h − ω² q and k = F h':
///   ∫ F h(t) q̇ dt = F h (q⁺ − q) + k [ℓ (q⁺ − q) − c q̇ − r g − w k],   ∫ Γ (dū/dt) q̈ dt = Γ (dū/dt) (q̇⁺ − q̇)
Work ForcedResponse::advance(const Interval& over, const Vector& constant, Vector& q, Vector& v) noexcept {
  Work work;
  for (double t = over.from;;) {
    const double knot = next_knot(t), end = std::min(knot, over.to), length = end - t;
    const bool whole = over.whole && t == over.from && knot >= over.to;
    force(t, value_, slope_);
    lift_.setZero();
    for (const Model::Forcing& forcing : acting())
      if (forcing.support)
        lift_.segment(forcing.first_mode, forcing.lift.size()) += forcing.history.slope(t) * forcing.lift;
    for (Eigen::Index n = 0; n < q.size(); ++n) {
      const ModeStep m = whole ? whole_[n] : mode_step(omega_(n), decay_(n), length);
      const double k = slope_(n), g = constant(n) + value_(n) - omega_(n) * omega_(n) * q(n);
      const double dq = m.S * v(n) + m.c * g + m.r * k, next_v = m.rate * v(n) + m.S * g + m.c * k;
      work.damping += 2 * decay_(n) *
                      (m.ss * g * g + 2 * m.sr * g * v(n) + m.rr * v(n) * v(n) + m.c * m.c * g * k +
                       2 * (m.S * m.c - m.ss) * v(n) * k + m.cc * k * k);
      work.forcing +=
          value_(n) * dq + k * (length * dq - m.c * v(n) - m.r * g - m.w * k) + lift_(n) * (next_v - v(n));
      q(n) += dq;
      v(n) = next_v;
    }
    if (knot <= over.to) velocity_jump(knot, v);
    if (end >= over.to) return work;
    t = end;
  }
}

}  // namespace ricochet::contact
