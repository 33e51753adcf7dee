// SPDX-License-Identifier: BSD-2-Clause
// Finds parts of a body that pass through an obstacle because they have no candidates.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "contact/model/model.hpp"

namespace ricochet::contact {

/// Compares the outline of each body, moved rigidly, with the obstacles of its pairs. Contact keeps only
/// candidates out of an obstacle.
///
/// A body in contact is flattened, so its rigid motion brings candidates into the obstacle by a depth d, and
/// their neighbours by about as much. A part passes through if it is deeper than 2 d and than 1e-3 of the
/// body's size.
class ObstacleCheck {
 public:
  /// `model` must outlive the check.
  explicit ObstacleCheck(const Model& model);

  /// @param q  (N) modal displacement, @param time  [s]
  void observe(const Vector& q, double time);

  std::vector<std::string> warnings() const;

 private:
  struct Side {  ///< a body and an obstacle
    int pair = 0;
    Eigen::Vector3d normal{0, 0, 1};  ///< out of the obstacle
    Eigen::Matrix3Xd outline;         ///< (3,H) world, initial [m]
    Eigen::Matrix3Xd candidate;       ///< (3,M) nodes of the candidates, likewise
    Eigen::Vector3d on{0, 0, 0};      ///< a point of the obstacle
    double least = 0;                 ///< depth that does not count [m]
    double deepest = 0, time = 0;     ///< deepest passage and its time
    Eigen::Vector3d at{0, 0, 0};      ///< where, in the initial position
  };
  const Model& model_;
  std::vector<Eigen::Matrix3d> inverse_inertia_;  ///< by body
  std::vector<Side> sides_;
};

}  // namespace ricochet::contact
