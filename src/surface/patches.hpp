// SPDX-License-Identifier: BSD-2-Clause
// Candidate contact patches on the surface of a body.
#pragma once

#include "ricochet/kernel.hpp"
#include "src/surface/spread.hpp"

namespace ricochet::surface {

/// Patches, the same on every rank.
struct Patches {
  kernels::Surface geometry;  ///< all but shape and residual flexibility
  std::vector<Weight> weights;
};

struct PatchOptions {
  std::optional<Vector3> direction{};  ///< unit: only this component of the trace is kept
  std::optional<Vector3> along{};      ///< unit: one patch for all that lies on a line in this direction
  std::optional<double> spacing{};     ///< [m] between candidates; none: every node of the subdivided surface
};

/// Hats w_i ≥ 0, Σ w_i = 1, on the vertices of the surface subdivided to the element order; merged along a
/// direction and thinned to a spacing when asked. Needs a GmshSession. `rod_area` is the cross-section of a
/// rod. Throws InputError when the mesh has no contact facets.
Patches make_patches(const mesh::Mesh& mesh, const std::vector<std::string>& groups,
                     const PatchOptions& options);

/// Leaves out all candidates but `points` (ascending). Patches and loads of those that stay are as before,
/// and the surface remembers them all (kernels::WholeSurface).
void keep(Patches& patches, const std::vector<std::int64_t>& points);

/// Loads of the patches: column c·i + k is a unit force on patch i in component k (c = 3), or along
/// `direction` (c = 1). Held components carry none. @return (local rows, c M) [N]
Eigen::MatrixXd patch_loads(const mesh::Mesh& mesh, const Patches& patches);

}  // namespace ricochet::surface
