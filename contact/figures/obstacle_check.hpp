// SPDX-License-Identifier: BSD-2-Clause
// Finds parts of a body that pass through an obstacle because they have no contact points, and bodies whose
// contact points are farther apart than their surfaces.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "contact/figures/passage_check.hpp"
#include "contact/figures/rigid_motion.hpp"
#include "contact/model/model.hpp"

namespace ricochet::contact {

/// Compares the outline of each body and the nodes of its contact surface, moved as a whole, with the
/// obstacles of its pairs. Contact keeps only the contact points out of an obstacle.
///
/// A body in contact is flattened, so its rigid motion brings contact points into the obstacle by a depth d,
/// and their neighbours by about as much. Nodes of a rounded surface lie beyond the points x̂ of their patches
/// by up to about the bulge b. A part passes through if it is deeper than 2 d + 2 b + 1e-3 of an element.
///
/// Also compares the smallest gap of each pair with the distance of the surfaces at the start, and looks for
/// bodies that pass through each other.
class ObstacleCheck {
 public:
  /// `model` must outlive the check.
  explicit ObstacleCheck(const Model& model);

  /// @param motions  displacement of each body, @param time  [s]
  void observe(const std::vector<RigidMotion>& motions, double time);

  std::vector<std::string> warnings() const;

 private:
  struct Side {  ///< a body and a half-space
    int pair = 0;
    Eigen::Vector3d normal{0, 0, 1};  ///< out of the obstacle
    Eigen::Matrix3Xd outline;         ///< (3,H + M) outline and nodes, world, initial [m]
    Eigen::Matrix3Xd point;           ///< (3,m) contact points, likewise
    Eigen::Vector3d on{0, 0, 0};      ///< a point of the obstacle
    double least = 0;                 ///< depth that does not count [m]
    double deepest = 0, time = 0;     ///< deepest passage and its time
    Eigen::Vector3d at{0, 0, 0};      ///< where, in the initial position
  };
  const Model& model_;
  std::vector<Side> sides_;
  PassageCheck passages_;
};

}  // namespace ricochet::contact
