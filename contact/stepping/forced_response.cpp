// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/forced_response.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ricochet::contact {

ForcedResponse::ForcedResponse(const Model& model, double step, bool static_modes)
    : step_(step),
      omega_(model.omega),
      decay_(model.decay),
      s_(model.static_displacement),
      forcing_(model.forcing) {
  const Eigen::Index N = model.omega.size();
  whole_.resize(N);
  for (Eigen::Index n = 0; n < N; ++n) {
    if (static_modes && !sampled(omega_(n), step)) {
      const Vector flexible = model.B.col(n) / (omega_(n) * omega_(n));
      s_ += flexible * model.load(n);
      for (Model::Forcing& forcing : forcing_)
        if (const Eigen::Index i = n - forcing.first_mode; i >= 0 && i < forcing.force.size()) {
          forcing.displacement += flexible * forcing.force(i);
          forcing.force(i) = forcing.lift(i) = 0;
        }
      omega_(n) = decay_(n) = 0;
    }
    whole_[n] = mode_step(omega_(n), decay_(n), step);
  }
  for (Vector* x : {&value_, &slope_, &lift_}) x->setZero(N);
}

ForcedResponse::Interval ForcedResponse::start() const {
  Interval out;
  for (Vector* x : {&out.q, &out.v, &out.lift}) x->setZero(omega_.size());
  out.s = out.rate = Vector::Zero(s_.size());
  fill(out);
  return out;
}

void ForcedResponse::step(std::int64_t k, Interval& out) const noexcept {
  out.from = static_cast<double>(k - 1) * step_;
  out.to = static_cast<double>(k) * step_;
  out.whole = true;
  fill(out);
}

void ForcedResponse::interval(double from, double to, Interval& out) const noexcept {
  out.from = from;
  out.to = to;
  out.whole = to == from + step_;
  fill(out);
}

/// Response from rest, where ℓ is the time from a knot to the end:
///   loads:     q = F [h c + h' r] at the start, and F [J c(ℓ) + K r(ℓ)] from each knot; q̇ likewise by S, c
///   supports:  q = −Γ K S(ℓ), q̇ = −Γ K S'(ℓ) from each knot
void ForcedResponse::fill(Interval& out) const noexcept {
  points(out.to, out.s, out.rate);
  for (Vector* x : {&out.q, &out.v, &out.lift}) x->setZero();
  for (const Model::Forcing& forcing : forcing_) {
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
  for (const Model::Forcing& forcing : forcing_)
    if (!forcing.support) {
      value.segment(forcing.first_mode, forcing.lift.size()) += forcing.history.at(t) * forcing.force;
      slope.segment(forcing.first_mode, forcing.lift.size()) += forcing.history.slope(t) * forcing.force;
    }
}

void ForcedResponse::points(double t, Vector& s, Vector& rate) const noexcept {
  s = s_;
  rate.setZero();
  for (const Model::Forcing& forcing : forcing_) {
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
  for (const Model::Forcing& forcing : forcing_) {
    const std::size_t knot = forcing.history.passed(t);
    if (knot < forcing.history.time.size()) next = std::min(next, forcing.history.time[knot]);
  }
  return next;
}

void ForcedResponse::velocity_jump(double knot, Vector& v) const noexcept {
  for (const Model::Forcing& forcing : forcing_) {
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
    for (const Model::Forcing& forcing : forcing_)
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
