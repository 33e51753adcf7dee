// SPDX-License-Identifier: BSD-2-Clause
// The kernel of one body from its mesh: candidates, modes or Ritz vectors, and their trace.
#pragma once

#include "src/kernel/candidates.hpp"

namespace ricochet::kernel {

/// Computes the kernel of one body from its mesh, on all ranks. Rank 0 returns the whole kernel; other ranks
/// return it without the visualisation surface. Collective.
/// @param request     its `view` becomes true if the visualisation surface takes at most `view_mib`
/// @param checkpoint  folder of finished slices, read and extended
/// @param view_mib    size up to which the surface is kept, although the request has none [MiB]
/// Throws InputError on every rank, or SolverError.
kernels::Kernel compute(scene::KernelRequest& request, const std::filesystem::path& checkpoint,
                        double view_mib, OpenedMeshes& meshes, MPI_Comm comm, console::Console& console);

}  // namespace ricochet::kernel
