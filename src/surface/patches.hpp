// SPDX-License-Identifier: BSD-2-Clause
// Candidate contact patches on the surface of a body.
#pragma once

#include <map>

#include "ricochet/kernel.hpp"
#include "src/reduction/static_flexibility.hpp"
#include "src/surface/spread.hpp"

namespace ricochet::surface {

/// The patches of a body, the same on every rank.
struct Patches {
  kernels::Surface geometry;  ///< all except shape and residual flexibility
  std::vector<Weight> weights;
  /// (M) of each hat of the subdivided surface, by vertex: index into the nodes of mesh::Mesh::contact
  std::vector<std::map<std::int64_t, double>> share;
  std::vector<double> arm;  ///< (M,3) from the mean (1/A_i) ∫ w_i x ds of each patch to its centroid x̂_i [m]
};

struct PatchOptions {
  std::optional<Vector3> direction{};  ///< unit vector: only this component of the trace is kept
  std::optional<Vector3> along{};      ///< unit vector: vertices on a line in this direction are merged
  /// Distance between candidates [m]. Without it, every node of the subdivided surface is a candidate.
  std::optional<double> spacing{};
};

/// Makes patches with hats w_i ≥ 0, Σ w_i = 1, on the vertices of the surface, which is subdivided to the
/// element order. On request, they are merged along a direction and coarsened to a spacing. The ends of the
/// contact surface are treated like creases, because an edge or a plane of symmetry is there. Needs a
/// GmshSession. Throws InputError if the mesh has no contact facets.
Patches make_patches(const mesh::Mesh& mesh, const std::vector<std::string>& groups,
                     const PatchOptions& options);

/// Keeps only the candidates `points`, in ascending order. Their patches and loads do not change. The
/// geometry of all candidates is kept as kernels::WholeSurface.
void restrict_to(Patches& patches, const std::vector<std::int64_t>& points);

/// Returns the loads of the patches: column c·i + k is a unit force on patch i in component k (c = 3), or
/// along `direction` (c = 1). Fixed components are 0.
/// @return (local rows, c M) [N]
reduction::Loads patch_loads(const mesh::Mesh& mesh, const Patches& patches);

/// Returns the part of the loads of patches that act along the normals.
/// @param loads  (local rows, 3 M), @return (local rows, M)
reduction::Loads along_normals(const reduction::Loads& loads, const kernels::Surface& surface);

}  // namespace ricochet::surface
