// SPDX-License-Identifier: BSD-2-Clause
// The distance of two surfaces, without candidates.
#pragma once

#include "contact/pairing/surface_projection.hpp"

namespace ricochet::contact {

/// Returns the smallest distance between the curved elements of two surfaces, to within `tolerance`; 0 if
/// they intersect.
double surface_distance(const SurfaceProjection& a, const SurfaceProjection& b, double tolerance);

/// Returns the smallest height of a surface over a half-space, to within `tolerance`; negative inside.
double surface_distance(const WorldSurface& a, const Obstacle& b, double tolerance);

}  // namespace ricochet::contact
