// SPDX-License-Identifier: BSD-2-Clause
#include "contact/rows/driven_motion.hpp"

#include <algorithm>
#include <limits>

namespace ricochet::contact {

using Eigen::Vector3d;

bool DrivenMotion::turns() const noexcept {
  return std::ranges::any_of(parts, [](const Part& one) { return !one.turn.isZero(0); });
}

Vector3d DrivenMotion::shift(double t) const noexcept {
  Vector3d out = Vector3d::Zero();
  for (const Part& one : parts) out += one.history.at(t) * one.shift;
  return out;
}

Vector3d DrivenMotion::turn(double t) const noexcept {
  Vector3d out = Vector3d::Zero();
  for (const Part& one : parts) out += one.history.at(t) * one.turn;
  return out;
}

/// All turns have one axis, so that their rates are those of angles.
Vector3d DrivenMotion::velocity(double t, const Vector3d& place) const noexcept {
  const Vector3d arm = place - shift(t);
  Vector3d out = Vector3d::Zero();
  for (const Part& one : parts) out += one.history.slope(t) * (one.shift + one.turn.cross(arm));
  return out;
}

bool DrivenMotion::moves(double from, double to) const noexcept {
  return std::ranges::any_of(parts, [&](const Part& one) { return one.history.steepest(from, to) > 0; });
}

double DrivenMotion::speed(double from, double to, double radius) const noexcept {
  double sum = 0;
  for (const Part& one : parts)
    sum += one.history.steepest(from, to) * (one.shift.norm() + radius * one.turn.norm());
  return sum;
}

double DrivenMotion::next_knot(double t) const noexcept {
  double out = std::numeric_limits<double>::infinity();
  for (const Part& one : parts)
    if (const std::size_t next = one.history.passed(t); next < one.history.time.size())
      out = std::min(out, one.history.time[next]);
  return out;
}

}  // namespace ricochet::contact
