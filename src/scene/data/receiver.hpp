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
  Vector3 at{};             ///< [m]
  Axes axes = Axes::world;  ///< along which its motion is recorded
  Axes at_axes =
      Axes::world;  ///< of `at`: of the world, bodies as placed by the scene, or of the body's mesh
  bool operator==(const Receiver&) const = default;
};

}  // namespace ricochet::scene
