// Steps of the impulse scheme that meet each closing point at the instant at which it closes.
#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/stepping/integrator.hpp"

namespace ricochet::contact {

// Of a margin for touching: what is closed here has to be so for `impulses` too.
constexpr double closed = 0.5;

/// As step_impulse, in stretches that end where an open point closes.
StepStatus Integrator::step_exact() noexcept {
  const double start = time(), end = static_cast<double>(steps_ + 1) * options_.step;
  next_q_ = q_;
  next_v_ = v_;
  now_.s = s_;
  impulse_.setZero();
  open_.clear();
  const double size = q_.norm();
  for (Eigen::Index i = 0; i < system_->gap.size(); ++i)
    if (steps_ == 0 || u_(i) < system_->gap(i) - round_off(i, size)) open_.push_back(static_cast<int>(i));

  Drives::Work spent;
  double work = 0;
  for (double from = start;;) {
    const double to = first_closing(from, end);
    if (from == start && to == end)
      drives_.step(steps_ + 1, now_);
    else
      drives_.stretch(from, to, now_);
    const Drives::Work more = drives_.advance(now_, system_->load, next_q_, next_v_);
    spent.damping += more.damping;
    spent.drives += more.drives;
    next_u_ = now_.s;
    next_u_.noalias() += system_->B * next_q_;
    const SolveStatus status = impulses(now_);
    if (!has_forces(status)) return failure(status);
    if (push_by(next_force_) > 0) work += strike(spent);
    impulse_ += next_force_;
    if (!(to < end)) break;
    std::erase_if(open_, [&](int i) { return std::binary_search(touching_.begin(), touching_.end(), i); });
    from = to;
  }
  next_force_ = impulse_ / options_.step;
  return commit(work, 0, -work / options_.step, static_cast<int>((next_force_.array() > 0).count()), spent);
}

/// How long the open points stay open for certain from (work_q_, work_v_), `passed` after the last knot; 0
/// when one of them has closed.
double Integrator::safe_time(double passed) noexcept {
  double shortest = std::numeric_limits<double>::infinity();
  const double size = work_q_.norm();
  for (const int i : open_) {
    const double distance =
        system_->gap(i) - ahead_.s(i) - passed * rate_(i) - system_->B.row(i).dot(work_q_);
    if (!(distance > closed * round_off(i, size))) return 0;
    const double rate = system_->B.row(i).dot(work_v_) + rate_(i);
    shortest = std::min(shortest, 2 * distance / (rate + std::sqrt(rate * rate + 2 * bound_(i) * distance)));
  }
  return shortest;
}

/// The first instant in [from, to) at which an open point of the motion from (next_q_, next_v_) closes to
/// round-off; `to` when there is none.
///
/// Between knots |q̈| ≤ √(q̈² + ω² q̇²) + |f'| ℓ, as damping takes energy from q̈ and q̇ too. So |ü_i| ≤ A_i, and
/// a point at the distance d that closes at the rate u̇ stays open while u̇ t + ½ A t² < d. Steps of that
/// length can't pass the first closing, and converge to it as Newton's do.
double Integrator::first_closing(double from, double to) noexcept {
  if (open_.empty()) return to;
  at_q_ = next_q_;
  at_v_ = next_v_;
  for (double t = from; t < to;) {
    const double end = std::min(to, drives_.next_knot(t)), length = end - t;
    drives_.force(t, force_at_, slope_at_);
    drives_.points(t, ahead_.s, rate_);
    force_at_ += system_->load;
    drives_.bound(length, force_at_, slope_at_, at_q_, at_v_, push_);
    for (const int i : open_) bound_(i) = system_->B.row(i).cwiseAbs().dot(push_);
    work_q_ = at_q_;
    work_v_ = at_v_;
    for (double passed = 0;;) {
      const double safe = safe_time(passed);
      if (!(passed + safe > passed)) return t + passed;
      passed += safe;
      if (passed >= length) break;
      drives_.glide(passed, force_at_, slope_at_, at_q_, at_v_, work_q_, work_v_);
    }
    drives_.glide(length, force_at_, slope_at_, at_q_, at_v_, work_q_, work_v_);
    at_q_.swap(work_q_);
    at_v_.swap(work_v_);
    drives_.kick(end, at_v_);
    t = end;
  }
  return to;
}

}  // namespace ricochet::contact
