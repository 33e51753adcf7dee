// SPDX-License-Identifier: BSD-2-Clause
// Kernels from modes that another program computed.
#pragma once

#include <mpi.h>

#include "ricochet/kernel.hpp"
#include "src/console/console.hpp"
#include "src/scene/request.hpp"

namespace ricochet::kernel {

/// Whether the body file of an imported body contains modes, not matrices. Collective; throws InputError on
/// every rank.
bool holds_modes(const scene::Body& body, MPI_Comm comm);

/// Returns the kernel of a body whose file contains modes (docs/interchange.md) on rank 0, and an empty one
/// on other ranks. The rigid modes of a free body follow from its mass and inertia. There is no proof that
/// the file contains all modes, and the certificate records this. Needs a GmshSession. Collective. Throws
/// InputError on every rank if the layout is different, if the file contains less than the scene requests, or
/// if the number of rigid modes is wrong.
kernels::Kernel kernel_of_modes(const scene::KernelRequest& request, MPI_Comm comm,
                                console::Console& console);

}  // namespace ricochet::kernel
