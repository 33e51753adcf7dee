// SPDX-License-Identifier: BSD-2-Clause
// Verification of stored kernels: ricochet-kernel --verify.
#pragma once

#include <mpi.h>

#include "src/console/console.hpp"
#include "src/console/options.hpp"

namespace ricochet::scene {
struct Scene;
}

namespace ricochet::kernel {

/// Counts the modes of the kernels of a scene again, with K and M assembled from the mesh: below every shift
/// of the certificate, and in gaps between neighbouring modes, drawn at random, so that a wrong frequency is
/// found too. Prints a line for each body. Writes nothing. Collective.
/// @return 0 if all counts agree, otherwise 1. Throws InputError on every rank if a kernel is missing or has
/// no inertia counts.
int verify_kernels(const scene::Scene& scene, const console::Options& options, MPI_Comm comm,
                   console::Console& console);

}  // namespace ricochet::kernel
