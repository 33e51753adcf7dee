// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <numbers>
#include <string>

#include "ricochet/scheme.hpp"

namespace ricochet::scene {

/// Angle by which a free body may turn with linear rotations that its scene leaves open [rad].
inline constexpr double most_linear_turn = std::numbers::pi / 180;

/// How free bodies move as a whole.
struct Motion : RigidBodies {
  bool second_run = true;  ///< with finite rotations: finds out when motions separate
  /// Rotations are linear, but neither the scene nor anything in it excludes finite ones: they replace linear
  /// ones if a run finds that a body turns by more than most_linear_turn.
  bool rotation_open = false;
  /// What in the scene, or in its run, decides the rotation; empty: the key alone. Not compared, since the
  /// resolved scene gives the key.
  std::string reason{};
  bool is_finite() const { return rotation == Rotation::finite; }
  bool operator==(const Motion& other) const {
    return RigidBodies::operator==(other) && second_run == other.second_run &&
           rotation_open == other.rotation_open;
  }
};

}  // namespace ricochet::scene
