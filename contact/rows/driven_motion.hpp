// SPDX-License-Identifier: BSD-2-Clause
// The prescribed motion of a rigid obstacle, which nothing it meets can change.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "contact/rows/history.hpp"

namespace ricochet::contact {

/// Displacements and turns about one axis through the origin of the obstacle, which add up. All are 0 at t =
/// 0.
struct DrivenMotion {
  struct Part {
    Eigen::Vector3d shift{0, 0, 0};  ///< for a history of value 1 [m]
    Eigen::Vector3d turn{0, 0, 0};   ///< the same: axis times angle [rad]
    History history{};
  };
  std::vector<Part> parts{};

  bool turns() const noexcept;
  Eigen::Vector3d shift(double t) const noexcept;  ///< [m]
  Eigen::Vector3d turn(double t) const noexcept;   ///< axis times angle [rad]
  /// Of what is at a place at t, from t on. @param place  from the origin at t = 0, world axes [m] @return
  /// [m/s]
  Eigen::Vector3d velocity(double t, const Eigen::Vector3d& place) const noexcept;
  /// Whether it moves at any time within an interval.
  bool moves(double from, double to) const noexcept;
  /// Largest speed within it of a point that is at most `radius` [m] from the origin [m/s].
  double speed(double from, double to, double radius) const noexcept;
  /// The first time after t at which a velocity changes, or infinity if there is none [s].
  double next_knot(double t) const noexcept;
};

}  // namespace ricochet::contact
