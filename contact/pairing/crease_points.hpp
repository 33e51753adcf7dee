// SPDX-License-Identifier: BSD-2-Clause
// Contact points that no candidate of a holds: crossings of creases, and creases of b that face a.
#pragma once

#include "contact/pairing/surface_projection.hpp"

namespace ricochet::contact {

/// Adds to the pairs of candidates
///   - the points where a crease of a crosses one of b such that the distance is a local minimum, and
///   - nodes of b on its creases, projected onto a,
/// wherever they are nearer than the pairs around them by more than 1e-6 of an element, so that no two points
/// coincide.
/// @param shift  [m] of a since `a` was made
void add_crease_points(const SurfaceProjection& a, const Eigen::Vector3d& shift, const SurfaceProjection& b,
                       const std::optional<Eigen::Vector3d>& direction, Pairing& pairing);

/// The corners of a projection with their weights, without those of weight 0.
Pairing::Weights weights_of(const Projection& y);
/// Σ w_i x_i
double sum_of(const std::vector<double>& values, const Pairing::Weights& weights);

}  // namespace ricochet::contact
