// SPDX-License-Identifier: BSD-2-Clause
// From the mesh of a body to its matrices, on as many teams of ranks as memory allows.
#pragma once

#include <memory>

#include "src/kernel/candidates.hpp"
#include "src/reduction/static_flexibility.hpp"
#include "src/scene/request.hpp"
#include "src/surface/patches.hpp"
#include "src/surface/sources.hpp"

namespace ricochet::kernel {

/// Share of the free memory that a run uses: delayed pivots and buffers need more than estimated.
inline constexpr double usable = 0.85;

/// A body on every team of ranks, with an analysed factorisation.
struct Discretised {
  std::unique_ptr<parallel::Teams> teams;
  mesh::Mesh mesh;
  elasticity::Body matrices;
  std::unique_ptr<modes::Factorisation> factor;
  surface::Sources sources;          ///< loads with histories, moving supports, receivers
  surface::Patches patches;          ///< the candidates that the request keeps
  std::size_t candidates = 0;        ///< of the whole surface
  reduction::Loads loads;            ///< of the patches, in all components
  reduction::Loads pressed;          ///< those between which the residual flexibility is kept
  std::int64_t modes_per_shift = 0;  ///< modes searched from one shift
  double resident_mib = 0;           ///< before the factorisation, on the rank with most
};

/// Whether the residual flexibility of the body is compressed as it is computed.
bool is_compressed(const scene::KernelRequest& request, const Discretised& made);

/// Whether the kernel contains a residual flexibility.
bool has_flexibility(const scene::KernelRequest& request, const Discretised& made);

/// Assembles the matrices and analyses their factorisation, on as many teams as memory allows: ranks that
/// each hold the whole body and process their own slices are faster than ranks that share one. If memory is
/// short, the slices become smaller. A contact-adapted basis needs few factorisations, so all ranks form one
/// team. Throws InputError if memory does not suffice for one team. Needs a GmshSession. Collective.
/// @param request   its `view` becomes true if the visualisation surface takes at most `view_mib`
/// @param view_mib  size up to which the surface is kept, although the request has none [MiB]
Discretised discretise(scene::KernelRequest& request, double view_mib, OpenedMeshes& meshes, MPI_Comm comm,
                       console::Console& console);

/// Memory of the rank that needs most for a kernel with this number of modes [MiB]: a search of it, the
/// residual flexibility, and what is there before. Collective.
/// @param teams  that share the shapes
double needed_mib(const scene::KernelRequest& request, const Discretised& made, std::int64_t modes, int teams,
                  MPI_Comm comm);

/// States the memory that a search for this number of modes needs, and the slices and the time that are
/// planned for it. Collective; throws InputError on every rank if there is less memory.
/// @param seconds  0: unknown
void check_memory(const scene::KernelRequest& request, const Discretised& made, std::int64_t modes,
                  std::int64_t slices, double seconds, MPI_Comm comm, console::Console& console);

/// Checks on the mesh of a body whether its kernel can be computed. Collective; throws InputError on every
/// rank if it cannot.
void check_body(const scene::KernelRequest& request, OpenedMeshes& meshes, MPI_Comm comm,
                console::Console& console);

}  // namespace ricochet::kernel
