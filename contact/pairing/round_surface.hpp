// SPDX-License-Identifier: BSD-2-Clause
// Curved surfaces in closed form: what the curved elements of an obstacle's shape approximate.
#pragma once

#include <Eigen/Dense>

namespace ricochet::contact {

/// The axis is z, and the middle is the origin of its own axes.
struct RoundSurface {
  enum class Form : char {
    capsule,  ///< at the distance `radius` from a segment of `length`; a sphere if that is 0
    cone,     ///< unbounded, through circles of `radius` at −length/2 and of `radius_small` at length/2
    torus,    ///< at the distance `radius_small` from a circle of `radius`
  };
  Form form = Form::capsule;
  double radius = 0, radius_small = 0, length = 0;  ///< [m]
  double side = 1;                                  ///< −1: what is inside is free
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< [m]
  bool operator==(const RoundSurface&) const = default;

  /// The point of the surface that is closest to another one.
  struct At {
    Eigen::Vector3d point{0, 0, 0}, normal{0, 0, 0};  ///< [m]; unit, towards the free side
    double distance = 0;                              ///< along the normal; negative beyond the surface [m]
    Eigen::Matrix3d curvature = Eigen::Matrix3d::Zero();  ///< W with dn = W dx [1/m]
  };
  At closest(const Eigen::Vector3d& x) const noexcept;
};

}  // namespace ricochet::contact
