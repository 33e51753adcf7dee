// SPDX-License-Identifier: BSD-2-Clause
// ricochet-kernel: from a scene to one kernel file for each body.
#pragma once

#include <mpi.h>

#include "ricochet/kernel.hpp"
#include "src/console/console.hpp"
#include "src/scene/request.hpp"

namespace ricochet {

/// Computes the kernel of one body from its mesh, on all ranks. Rank 0 has all of it; other ranks lack the
/// visualisation surface. Collective.
/// @param checkpoint  folder of finished slices, read and extended
/// Throws InputError on every rank, or SolverError.
kernels::Kernel compute_kernel(const scene::KernelRequest& request, const std::filesystem::path& checkpoint,
                               MPI_Comm comm, console::Console& console);

/// Writes the kernels that `options.out` does not contain yet. @return the exit status. Collective.
int run_kernel(const console::Options& options, MPI_Comm comm);

}  // namespace ricochet
