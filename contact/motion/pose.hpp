// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <Eigen/Geometry>

namespace ricochet::contact {

/// Where the frame of a body is, and how it moves, in world axes.
struct Pose {
  Eigen::Vector3d position{0, 0, 0};        ///< of the centre of mass [m]
  Eigen::Quaterniond attitude{1, 0, 0, 0};  ///< from body axes, those of the kernel, to world axes
  Eigen::Vector3d velocity{0, 0, 0};        ///< of the centre [m/s]
  Eigen::Vector3d spin{0, 0, 0};            ///< [rad/s]

  /// Place [m] and velocity [m/s] of a point. @param arm, rate  from the centre, and its rate, body axes
  Eigen::Vector3d at(const Eigen::Vector3d& arm) const { return position + attitude * arm; }
  Eigen::Vector3d velocity_at(const Eigen::Vector3d& arm, const Eigen::Vector3d& rate) const {
    return velocity + spin.cross(attitude * arm) + attitude * rate;
  }
  void archive(auto& a) { a(position, attitude, velocity, spin); }
};

/// The matrix X with X y = x × y.
inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& x) {
  Eigen::Matrix3d out;
  out << 0, -x.z(), x.y(), x.z(), 0, -x.x(), -x.y(), x.x(), 0;
  return out;
}

}  // namespace ricochet::contact
