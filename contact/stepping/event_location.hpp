// SPDX-License-Identifier: BSD-2-Clause
// The first instant of a free motion at which an open point closes (event location).
//
// Let q̈ and q̇ be the values at a knot. Until the next knot, |q̈| is bounded at the time ℓ after the knot by
//
//   √(q̈² + ω² q̇²) + |f'| ℓ
//
// because damping only removes energy. This gives |ü_i| ≤ A_i. A point at the distance d that closes at the
// rate u̇ stays open while u̇ t + ½ A_i t² < d. Steps of that length cannot pass the first closing, and they
// converge to it as fast as Newton's method.
#pragma once

#include <vector>

#include "contact/stepping/modal_state.hpp"

namespace ricochet::contact {

class EventLocation {
 public:
  explicit EventLocation(const StepSystem& system);

  /// Selects the points that may close: all of them, or those that are open in `state` with the displacement
  /// u (m).
  void open_all() noexcept;
  void open(const ModalState& state, const Vector& u) noexcept;
  /// Removes points that have closed from the selection. @param points  ascending
  void close(const std::vector<int>& points) noexcept;

  /// Returns the first instant in [from, to) at which a selected point closes to round-off in the motion from
  /// (next_q, next_v), or `to` if there is none.
  double first_closing(double from, double to, const ModalState& state) noexcept;

  void archive(auto& a) { a(open_); }

 private:
  double safe_time(double passed, const ModalState& state) noexcept;

  std::vector<int> open_;
  Vector knot_q_, knot_v_;   ///< (N) at the last knot
  Vector q_, v_;             ///< (N) at an instant after it
  Vector force_, slope_;     ///< (N) modal force at the knot and its slope
  Vector acceleration_;      ///< (N) upper bound on |q̈|
  Vector s_, rate_, bound_;  ///< (m) s at the knot; ṡ; upper bound on |ü|
};

}  // namespace ricochet::contact
