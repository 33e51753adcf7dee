// SPDX-License-Identifier: BSD-2-Clause
// Finds parts of a body that pass through an obstacle because they have no contact points, and bodies whose
// contact points are farther apart than their surfaces.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "contact/figures/passage_check.hpp"
#include "contact/figures/rigid_motion.hpp"
#include "contact/model/model.hpp"
#include "contact/pairing/surface_projection.hpp"

namespace ricochet::contact {

/// Compares the outline of each body and the nodes of its contact surface, moved as a whole, with the
/// obstacles of its pairs. Contact keeps only the contact points out of an obstacle.
///
/// A body in contact is flattened, so its rigid motion brings contact points into the obstacle by a depth d,
/// and their neighbours by about as much. Nodes of a rounded surface lie beyond the points x̂ of their patches
/// by up to about the bulge b. A part passes through if it is deeper than 2 d + 2 b + 1e-3 of an element.
/// Into an obstacle with a surface, the depth is that below its closest point.
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
  struct Side {  ///< a body and an obstacle
    int pair = 0;
    Eigen::Vector3d normal{0, 0, 1};  ///< out of a half-space
    Eigen::Matrix3Xd outline;         ///< (3,H + M) outline and nodes, world, initial [m]
    Eigen::Matrix3Xd point;           ///< (3,m) contact points, likewise
    Eigen::Vector3d on{0, 0, 0};      ///< a point of a half-space
    double least = 0;                 ///< depth that does not count [m]
    double deepest = 0, time = 0;     ///< deepest passage and its time
    Eigen::Vector3d at{0, 0, 0};      ///< where, in the initial position
    // Of an obstacle with a surface
    std::optional<SurfaceProjection> surface{};  ///< in its axes
    Eigen::AlignedBox3d box{};                   ///< around it
    bool holds = false;                          ///< whether bodies are within it
    Pose place{};                                ///< at t = 0
    Eigen::Matrix3Xd looked_at{};  ///< corners around the outline, in its axes, when last looked at
    std::int64_t searches = 0;     ///< of closest points
  };
  void observe_plane(Side& side, const RigidMotion& motion, double time);
  void observe_surface(Side& side, const RigidMotion& motion, double time);
  const Model& model_;
  std::vector<Side> sides_;
  PassageCheck passages_;
};

}  // namespace ricochet::contact
