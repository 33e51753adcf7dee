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
};

}  // namespace ricochet::contact
