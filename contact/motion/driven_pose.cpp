// SPDX-License-Identifier: BSD-2-Clause
#include "contact/motion/driven_pose.hpp"

namespace ricochet::contact {

Pose driven_pose(const DrivenMotion& motion, const Pose& start, double t) noexcept {
  Pose out = start;
  out.position += motion.shift(t);
  const Eigen::Vector3d turned = motion.turn(t);
  if (const double angle = turned.norm(); angle > 0)
    out.attitude = Eigen::Quaterniond(Eigen::AngleAxisd(angle, turned / angle)) * start.attitude;
  return out;
}

}  // namespace ricochet::contact
