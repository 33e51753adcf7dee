// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include "ricochet/scheme.hpp"

namespace ricochet::scene {

/// How free bodies move as a whole.
struct Motion : RigidBodies {
  bool second_run = true;  ///< with finite rotations: finds out when motions separate
  bool is_finite() const { return rotation == Rotation::finite; }
  bool operator==(const Motion&) const = default;
};

}  // namespace ricochet::scene
