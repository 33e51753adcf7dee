// SPDX-License-Identifier: BSD-2-Clause
// The obstacles of a model as files show them: triangles and prescribed motion.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "contact/model/model.hpp"
#include "contact/motion/driven_pose.hpp"

namespace ricochet::contact {

struct ObstacleSurface {
  std::string name;
  bool is_half_space = false;  ///< its triangles are those of the part that is near its contact points
  Matrix node{};               ///< (n,3) at t = 0, world axes [m]
  std::vector<std::int64_t> element{};  ///< (3·triangles)
  Pose start{};  ///< at t = 0, of its own axes; of a half-space, the position is that of a point on its
                 ///< surface
  std::shared_ptr<const DrivenMotion> driven{};  ///< null if it does not move

  /// (n,3) the nodes at a time t [s], world axes [m]
  Matrix at(double t) const;
};

/// The obstacles that a body may touch, once each, in the order of the pairs.
std::vector<ObstacleSurface> obstacle_surfaces(const Model& model);

}  // namespace ricochet::contact
