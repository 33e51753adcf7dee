// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <string>

#include "ricochet/scheme.hpp"
#include "ricochet/units.hpp"

namespace ricochet::scene {

/// A point of a body whose motion is recorded.
struct Receiver {
  std::string name;
  std::string body;
  Vector3 at{};             ///< in world axes, bodies as placed by the scene [m]
  Axes axes = Axes::world;  ///< along which its motion is recorded
  bool operator==(const Receiver&) const = default;
};

}  // namespace ricochet::scene
