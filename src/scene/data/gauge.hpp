// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <optional>
#include <string>

#include "ricochet/scheme.hpp"
#include "ricochet/units.hpp"

namespace ricochet::scene {

/// A point of a body whose stress is recorded, and its strain along a direction.
struct Gauge {
  std::string name;
  std::string body;
  Vector3 at{};                        ///< [m]
  Axes at_axes = Axes::world;          ///< of `at` and `direction`, as of a receiver
  std::optional<Vector3> direction{};  ///< unit vector
  double length = 0;                   ///< over which the strain is averaged [m]; 0: at the point
  bool operator==(const Gauge&) const = default;
};

}  // namespace ricochet::scene
