// SPDX-License-Identifier: BSD-2-Clause
// The errors of a kernel by its mesh, estimated on this mesh.
#pragma once

#include "src/elasticity/assemble.hpp"
#include "src/modes/modes.hpp"
#include "src/surface/patches.hpp"

namespace ricochet::surface {

/// Fills the estimates `mesh_error` of modes and surface. The kernel must have its modes, which are all of
/// `modes` or the lowest of them, and its residual flexibility, if it will have one. `loads` are those of the
/// patches. Frees the factors.
///
/// Frequencies: the hierarchical surplus of each mode or Ritz vector (elasticity/surplus.hpp). Flexibility:
/// problems around a few candidates (elasticity/local_problem.hpp), of a face, a crease and a corner, in the
/// middle of the candidates; others have the same relative error as those of their kind. A force on one of
/// them and all its neighbours shows how the error falls as a force spreads.
///
/// Collective on all ranks of `teams`. Needs a GmshSession.
void estimate_mesh_error(const parallel::Teams& teams, const mesh::Mesh& mesh,
                         const std::vector<scene::Material>& materials, const elasticity::Body& body,
                         modes::Factorisation& factor, const modes::ModeSet& modes, const Patches& patches,
                         const reduction::Loads& loads, kernels::Kernel& kernel,
                         const parallel::Progress& progress = {});

}  // namespace ricochet::surface
