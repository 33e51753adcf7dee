// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <numbers>

namespace ricochet::kernels {

/// Where the normals of facets that meet differ by more, a surface has a crease [rad]. Elements of order 2
/// and higher stay far below it on rounded surfaces, as do plane ones with at least 12 around a circle.
/// Chamfers and the edges of polygons lie above it.
inline constexpr double crease_angle = 29 * std::numbers::pi / 180;

}  // namespace ricochet::kernels
