// SPDX-License-Identifier: BSD-2-Clause
// The rotation of bodies, shared by scenes and by programs that embed the library.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "ricochet/units.hpp"

namespace ricochet {

/// Rotation about the fixed axes x, then y, then z, each by an angle in degrees. Exact for quarter turns.
/// @return row-major (3,3): world = rotation · body
inline std::array<double, 9> rotation_of(const Vector3& degrees) {
  const auto cosine = [](double angle) {
    const double r = std::remainder(angle, 360.0);
    if (std::abs(r) == 90) return 0.0;
    return std::cos(r * std::numbers::pi / 180);
  };
  const auto sine = [](double angle) {
    const double r = std::remainder(angle, 360.0);
    return std::abs(r) == 180 ? 0.0 : std::sin(r * std::numbers::pi / 180);
  };
  const double cx = cosine(degrees[0]), sx = sine(degrees[0]);
  const double cy = cosine(degrees[1]), sy = sine(degrees[1]);
  const double cz = cosine(degrees[2]), sz = sine(degrees[2]);
  return {cz * cy,
          cz * sy * sx - sz * cx,
          cz * sy * cx + sz * sx,
          sz * cy,
          sz * sy * sx + cz * cx,
          sz * sy * cx - cz * sx,
          -sy,
          cy * sx,
          cy * cx};
}

}  // namespace ricochet
