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

/// Angles with this rotation, row-major (3,3). They are unique unless y is a quarter turn.
inline Vector3 degrees_of(const std::array<double, 9>& r) {
  const double x = std::atan2(r[7], r[8]), y = std::atan2(-r[6], std::hypot(r[0], r[3])), cx = std::cos(x),
               sx = std::sin(x), z = std::atan2(sx * r[2] - cx * r[1], cx * r[4] - sx * r[5]),
               degrees = 180 / std::numbers::pi;
  return {degrees * x, degrees * y, degrees * z};
}

}  // namespace ricochet
