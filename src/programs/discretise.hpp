// SPDX-License-Identifier: BSD-2-Clause
// A body from its mesh to its matrices, on teams of ranks as memory allows.
#pragma once

#include <memory>

#include "src/modes/factorisation.hpp"
#include "src/programs/kernel_candidates.hpp"
#include "src/scene/request.hpp"
#include "src/surface/sources.hpp"

namespace ricochet {

/// A body on every team of ranks, its factorisation analysed.
struct Discretised {
  std::unique_ptr<parallel::Teams> teams;
  mesh::Mesh mesh;
  elasticity::Body matrices;
  std::unique_ptr<modes::Factorisation> factor;
  surface::Sources sources;          ///< loads with histories, moving supports, receivers
  std::int64_t modes_per_shift = 0;  ///< for the search for modes
};

/// As many teams as memory has room for: ranks that work at slices of their own, each with all of the body,
/// are faster than ranks that share one. Where room is short, slices become smaller. Vectors fitted to
/// contact need few factorisations, which ranks share better. Throws InputError when there is not even room
/// for one team. Needs a GmshSession. Collective.
Discretised discretise(const scene::KernelRequest& request, MPI_Comm comm, console::Console& console);

/// Checks from its mesh whether a body's kernel can be computed. Throws InputError on every rank if not.
/// Collective.
void check_body(const scene::KernelRequest& request, MPI_Comm comm, console::Console& console);

}  // namespace ricochet
