// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <string>

#include "ricochet/units.hpp"

namespace ricochet::scene {

/// Rigid half-space {x : (x − point)·normal ≤ 0}.
struct Obstacle {
  std::string name;
  Vector3 point{};
  Vector3 normal{};    ///< unit vector, pointing out of the obstacle
  Vector3 velocity{};  ///< along its surface [m/s]; felt only with friction
  bool operator==(const Obstacle&) const = default;
};

/// The component of a vector along the normal of the obstacle; exactly 0 if it is round-off.
double along_normal(const Obstacle& obstacle, const Vector3& vector);

}  // namespace ricochet::scene
