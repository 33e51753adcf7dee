// Candidate contact patches on a body's surface, and the trace of modes on them.
#pragma once

#include <Eigen/Dense>

#include "kernels/kernel.hpp"
#include "src/mesh/mesh.hpp"
#include "src/modes/modes.hpp"

namespace ricochet::surface {

/// One weight of a patch: candidate i spreads a unit force on the nodes, C(node, i) = (1/A_i) ∫ w_i N_node
/// ds.
struct Weight {
  std::int64_t node;  ///< global
  int candidate;
  double value;
};

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

/// Loads of the patches: column c·i + k is a unit force on patch i in component k (c = 3), or along
/// `direction` (c = 1). Held components carry none. @return (local rows, c M) [N]
Eigen::MatrixXd patch_loads(const mesh::Mesh& mesh, const Patches& patches);

/// Fills shape, residual flexibility and loads of a kernel, and its view when asked; the same on every rank
/// but for the view, which is on rank 0. `loads` are those of the patches. Collective.
void trace(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
           modes::Factorisation& factor, const modes::ModeSet& modes, const Patches& patches,
           const Eigen::MatrixXd& loads, bool residual, bool view, kernels::Kernel& kernel);

}  // namespace ricochet::surface
