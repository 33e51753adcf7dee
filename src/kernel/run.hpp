// SPDX-License-Identifier: BSD-2-Clause
// ricochet-kernel as a function: reads a scene and writes one kernel file for each body.
#pragma once

#include <mpi.h>

#include "src/console/options.hpp"

namespace ricochet::kernel {

/// Computes and writes the kernels that `options.out` does not contain yet. @return the exit status.
/// Collective.
int run_kernel(const console::Options& options, MPI_Comm comm);

}  // namespace ricochet::kernel
