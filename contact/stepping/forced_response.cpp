#include "contact/stepping/forced_response.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ricochet::contact {

Drives::Drives(const Model& model, double step, bool static_modes)
    : step_(step), omega_(model.omega), decay_(model.decay), s_(model.static_displacement) {
  const Eigen::Index N = model.omega.size();
  for (const Model::Drive& drive : model.drives) {
    const Model::BodyBlock& body = model.bodies[drive.body];
    drives_.push_back({drive.history, body.first_mode, body.modes, drive.force, drive.lift,
                       drive.displacement, drive.support});
  }
  whole_.resize(static_cast<std::size_t>(N));
  for (Eigen::Index n = 0; n < N; ++n) {
    if (static_modes && !sampled(omega_(n), step)) {
      const Vector flexible = model.B.col(n) / (omega_(n) * omega_(n));
      s_ += flexible * model.load(n);
      for (Drive& drive : drives_)
        if (n >= drive.first && n < drive.first + drive.modes) {
          drive.displacement += flexible * drive.force(n - drive.first);
          drive.force(n - drive.first) = drive.lift(n - drive.first) = 0;
        }
      omega_(n) = decay_(n) = 0;
    }
    whole_[n] = mode_step(omega_(n), decay_(n), step);
  }
  for (Vector* x : {&value_, &slope_, &lift_}) x->setZero(N);
}

Drives::Stretch Drives::start() const {
  Stretch out;
  for (Vector* x : {&out.q, &out.v, &out.lift}) x->setZero(omega_.size());
  out.s = out.rate = Vector::Zero(s_.size());
  fill(out);
  return out;
}

void Drives::step(std::int64_t k, Stretch& out) const noexcept {
  out.from = static_cast<double>(k - 1) * step_;
  out.to = static_cast<double>(k) * step_;
  out.whole = true;
  fill(out);
}

void Drives::stretch(double from, double to, Stretch& out) const noexcept {
  out.from = from;
  out.to = to;
  out.whole = to == from + step_;
  fill(out);
}

/// From rest, with ℓ the time that is left:
///   loads:     q = F [h c + h' r] at the start, and F [J c(ℓ) + K r(ℓ)] from each knot; q̇ likewise by S, c
///   supports:  q = −Γ K S(ℓ), q̇ = −Γ K S'(ℓ) from each knot
void Drives::fill(Stretch& out) const noexcept {
  points(out.to, out.s, out.rate);
  for (Vector* x : {&out.q, &out.v, &out.lift}) x->setZero();
  for (const Drive& drive : drives_) {
    const History& h = drive.history;
    if (drive.support) {
      out.lift.segment(drive.first, drive.modes) += h.slope(out.to) * drive.lift;
    } else {
      const double value = h.at(out.from), slope = h.slope(out.from);
      for (Eigen::Index i = 0; i < drive.modes; ++i) {
        const Eigen::Index n = drive.first + i;
        double S = whole_[n].h, c = whole_[n].c, r = whole_[n].r;
        if (!out.whole) {
          const ModeResponse m = mode_response(omega_(n), decay_(n), out.to - out.from);
          S = m.S, c = m.c, r = m.r;
        }
        out.q(n) += drive.force(i) * (value * c + slope * r);
        out.v(n) += drive.force(i) * (value * S + slope * c);
      }
    }
    for (std::size_t j = h.passed(out.from), end = h.passed(out.to); j < end; ++j) {
      const double left = out.to - h.time[j], jump = h.jump(j), kink = h.kink(j);
      for (Eigen::Index i = 0; i < drive.modes; ++i) {
        const Eigen::Index n = drive.first + i;
        const ModeResponse m = mode_response(omega_(n), decay_(n), left);
        out.q(n) += drive.force(i) * (jump * m.c + kink * m.r) - drive.lift(i) * kink * m.S;
        out.v(n) += drive.force(i) * (jump * m.S + kink * m.c) - drive.lift(i) * kink * m.rate;
      }
    }
  }
}

void Drives::force(double t, Vector& value, Vector& slope) const noexcept {
  value.setZero();
  slope.setZero();
  for (const Drive& drive : drives_)
    if (!drive.support) {
      value.segment(drive.first, drive.modes) += drive.history.at(t) * drive.force;
      slope.segment(drive.first, drive.modes) += drive.history.slope(t) * drive.force;
    }
}

void Drives::points(double t, Vector& s, Vector& rate) const noexcept {
  s = s_;
  rate.setZero();
  for (const Drive& drive : drives_) {
    s += drive.history.at(t) * drive.displacement;
    rate += drive.history.slope(t) * drive.displacement;
  }
}

void Drives::glide(double time, const Vector& force, const Vector& slope, const Vector& q, const Vector& v,
                   Vector& then_q, Vector& then_v) const noexcept {
  for (Eigen::Index n = 0; n < q.size(); ++n) {
    const ModeResponse m = mode_response(omega_(n), decay_(n), time);
    const double g = force(n) - omega_(n) * omega_(n) * q(n);
    then_q(n) = q(n) + m.S * v(n) + m.c * g + m.r * slope(n);
    then_v(n) = m.rate * v(n) + m.S * g + m.c * slope(n);
  }
}

void Drives::bound(double time, const Vector& force, const Vector& slope, const Vector& q, const Vector& v,
                   Vector& acceleration) const noexcept {
  for (Eigen::Index n = 0; n < q.size(); ++n)
    acceleration(n) =
        std::hypot(force(n) - 2 * decay_(n) * v(n) - omega_(n) * omega_(n) * q(n), omega_(n) * v(n)) +
        std::abs(slope(n)) * time;
}

double Drives::next_knot(double t) const noexcept {
  double next = std::numeric_limits<double>::infinity();
  for (const Drive& drive : drives_) {
    const std::size_t knot = drive.history.passed(t);
    if (knot < drive.history.time.size()) next = std::min(next, drive.history.time[knot]);
  }
  return next;
}

void Drives::kick(double knot, Vector& v) const noexcept {
  for (const Drive& drive : drives_) {
    if (!drive.support) continue;
    const std::size_t next = drive.history.passed(knot);
    if (next > 0 && drive.history.time[next - 1] == knot)
      v.segment(drive.first, drive.modes) -= drive.history.kink(next - 1) * drive.lift;
  }
}

/// Piece by piece, g = f + F h − ω² q, k = F h', ℓ its length:
///   ∫ F h(t) q̇ dt = F h (q⁺ − q) + k [ℓ (q⁺ − q) − c q̇ − r g − w k],   ∫ Γ (dū/dt) q̈ dt = Γ (dū/dt) (q̇⁺ − q̇)
Drives::Work Drives::advance(const Stretch& over, const Vector& constant, Vector& q, Vector& v) noexcept {
  Work work;
  for (double t = over.from;;) {
    const double knot = next_knot(t), end = std::min(knot, over.to), length = end - t;
    const bool whole = over.whole && t == over.from && knot >= over.to;
    force(t, value_, slope_);
    lift_.setZero();
    for (const Drive& drive : drives_)
      if (drive.support) lift_.segment(drive.first, drive.modes) += drive.history.slope(t) * drive.lift;
    for (Eigen::Index n = 0; n < q.size(); ++n) {
      const ModeStep m = whole ? whole_[n] : mode_step(omega_(n), decay_(n), length);
      const double k = slope_(n), g = constant(n) + value_(n) - omega_(n) * omega_(n) * q(n);
      const double dq = m.b * v(n) + m.c * g + m.r * k, next_v = m.e * v(n) + m.h * g + m.c * k;
      work.damping += 2 * decay_(n) *
                      (m.ss * g * g + 2 * m.sr * g * v(n) + m.rr * v(n) * v(n) + m.c * m.c * g * k +
                       2 * (m.h * m.c - m.ss) * v(n) * k + m.cc * k * k);
      work.drives +=
          value_(n) * dq + k * (length * dq - m.c * v(n) - m.r * g - m.w * k) + lift_(n) * (next_v - v(n));
      q(n) += dq;
      v(n) = next_v;
    }
    if (knot <= over.to) kick(knot, v);
    if (end >= over.to) return work;
    t = end;
  }
}

}  // namespace ricochet::contact
