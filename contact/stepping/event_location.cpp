// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/event_location.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "contact/stepping/impulse_problem.hpp"

namespace ricochet::contact {

// Share of touching_margin within which a point counts as closed. It is below 1, so that ImpulseProblem finds
// that the point touches.
constexpr double closed = 0.5;

EventLocation::EventLocation(const StepSystem& system) {
  for (Vector* x : {&knot_q_, &knot_v_, &q_, &v_, &force_, &slope_, &acceleration_})
    x->setZero(system.stiffness.size());
  for (Vector* x : {&s_, &rate_, &bound_}) x->setZero(system.gap.size());
  open_.reserve(system.gap.size());
}

void EventLocation::open_all() noexcept {
  open_.resize(s_.size());
  std::iota(open_.begin(), open_.end(), 0);
}

void EventLocation::open(const ModalState& state, const Vector& u) noexcept {
  open_.clear();
  const StepSystem& system = *state.system;
  const double size = state.q.norm();
  for (Eigen::Index i = 0; i < system.gap.size(); ++i)
    if (u(i) < system.gap(i) - touching_margin(system, i, size, state.s(i)))
      open_.push_back(static_cast<int>(i));
}

void EventLocation::close(const std::vector<int>& points) noexcept {
  std::erase_if(open_, [&](int i) { return std::binary_search(points.begin(), points.end(), i); });
}

/// Returns a time for which the selected points certainly stay open from (q_, v_), `passed` after the last
/// knot, or 0 if one of them has closed.
double EventLocation::safe_time(double passed, const ModalState& state) noexcept {
  const StepSystem& system = *state.system;
  double shortest = std::numeric_limits<double>::infinity();
  const double size = q_.norm();
  for (const int i : open_) {
    const double distance = system.gap(i) - s_(i) - passed * rate_(i) - system.model->B.row(i).dot(q_);
    if (!(distance > closed * touching_margin(system, i, size, state.now.s(i)))) return 0;
    const double rate = system.model->B.row(i).dot(v_) + rate_(i);
    shortest = std::min(shortest, 2 * distance / (rate + std::sqrt(rate * rate + 2 * bound_(i) * distance)));
  }
  return shortest;
}

double EventLocation::first_closing(double from, double to, const ModalState& state) noexcept {
  if (open_.empty()) return to;
  const ForcedResponse& forcing = state.forcing;
  knot_q_ = state.next_q;
  knot_v_ = state.next_v;
  for (double t = from; t < to;) {
    const double end = std::min(to, forcing.next_knot(t)), length = end - t;
    forcing.force(t, force_, slope_);
    forcing.points(t, s_, rate_);
    force_ += state.system->load;
    forcing.bound(length, force_, slope_, knot_q_, knot_v_, acceleration_);
    for (const int i : open_) bound_(i) = state.system->model->B.row(i).cwiseAbs().dot(acceleration_);
    q_ = knot_q_;
    v_ = knot_v_;
    for (double passed = 0;;) {
      const double safe = safe_time(passed, state);
      if (!(passed + safe > passed)) return t + passed;
      passed += safe;
      if (passed >= length) break;
      forcing.free_flight(passed, force_, slope_, knot_q_, knot_v_, q_, v_);
    }
    forcing.free_flight(length, force_, slope_, knot_q_, knot_v_, q_, v_);
    knot_q_.swap(q_);
    knot_v_.swap(v_);
    forcing.velocity_jump(end, knot_v_);
    t = end;
  }
  return to;
}

}  // namespace ricochet::contact
