// SPDX-License-Identifier: BSD-2-Clause
// Kernels of modes that another program computed.
#pragma once

#include <mpi.h>

#include "ricochet/kernel.hpp"
#include "src/console/console.hpp"
#include "src/scene/request.hpp"

namespace ricochet {

/// Whether the body file of an imported body contains modes rather than matrices. Collective; throws
/// InputError on every rank.
bool holds_modes(const scene::Body& body, MPI_Comm comm);

/// The kernel of a body whose file contains modes (docs/interchange.md), on rank 0; empty on other ranks. The
/// rigid modes of a free body follow from its mass and inertia. Nothing proves that no other mode is missing;
/// the certificate records this. Needs a GmshSession. Collective. Throws InputError on every rank: another
/// layout, fewer data than the scene requests, five or seven rigid modes.
kernels::Kernel kernel_of_modes(const scene::KernelRequest& request, MPI_Comm comm,
                                console::Console& console);

}  // namespace ricochet
