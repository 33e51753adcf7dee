// SPDX-License-Identifier: BSD-2-Clause
// ricochet-kernel: from a scene to one kernel file a body.
#pragma once

#include <mpi.h>

#include "ricochet/kernel.hpp"

#include "src/console/console.hpp"
#include "src/console/options.hpp"
#include "src/scene/request.hpp"
#include "src/scene/scene.hpp"

namespace ricochet {

/// One body's kernel from its mesh, on all ranks; whole on rank 0, the view there alone. Collective.
/// @param checkpoint  folder of finished slices, used and filled. Throws InputError on every rank, or
/// SolverError.
kernels::Kernel compute_kernel(const scene::KernelRequest& request, const std::filesystem::path& checkpoint,
                               MPI_Comm comm, console::Console& console);

/// Writes the kernels that `options.out` does not hold yet. Collective; @return the exit status.
int run_kernel(const console::Options& options, MPI_Comm comm);

}  // namespace ricochet
