// SPDX-License-Identifier: BSD-2-Clause
// Candidate contact patches on the surface of a body.
#pragma once

#include "ricochet/kernel.hpp"
#include "src/surface/spread.hpp"

namespace ricochet::surface {

/// The patches of a body, the same on every rank.
struct Patches {
  kernels::Surface geometry;  ///< all except shape and residual flexibility
  std::vector<Weight> weights;
};

struct PatchOptions {
  std::optional<Vector3> direction{};  ///< unit: only this component of the trace is kept
  std::optional<Vector3> along{};      ///< unit: one patch for all vertices on a line in this direction
  std::optional<double> spacing{};     ///< [m] between candidates; none: every node of the subdivided surface
};

/// Hats w_i ≥ 0, Σ w_i = 1, on the vertices of the surface, which is subdivided to the element order. On
/// request they are merged along a direction and coarsened to a spacing. Needs a GmshSession. Throws
/// InputError if the mesh has no contact facets.
Patches make_patches(const mesh::Mesh& mesh, const std::vector<std::string>& groups,
                     const PatchOptions& options);

/// Keeps only the candidates `points` (ascending), with their patches and loads unchanged. The surface
/// records all candidates (kernels::WholeSurface).
void restrict_to(Patches& patches, const std::vector<std::int64_t>& points);

/// Loads of the patches: column c·i + k is a unit force on patch i in component k (c = 3), or along
/// `direction` (c = 1). Held components are 0. @return (local rows, c M) [N]
Eigen::MatrixXd patch_loads(const mesh::Mesh& mesh, const Patches& patches);

}  // namespace ricochet::surface
