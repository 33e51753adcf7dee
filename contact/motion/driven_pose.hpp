// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include "contact/motion/pose.hpp"
#include "contact/rows/driven_motion.hpp"

namespace ricochet::contact {

/// Position and attitude at t of what has the pose `start` at t = 0 and is driven.
Pose driven_pose(const DrivenMotion& motion, const Pose& start, double t) noexcept;

}  // namespace ricochet::contact
