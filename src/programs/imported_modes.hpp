// SPDX-License-Identifier: BSD-2-Clause
// Kernels of modes that another program computed.
#pragma once

#include <mpi.h>

#include "ricochet/kernel.hpp"
#include "src/console/console.hpp"
#include "src/scene/request.hpp"
#include "src/scene/scene.hpp"

namespace ricochet {

/// Whether the body file of an imported body holds modes, not matrices. Collective; throws InputError on
/// every rank.
bool holds_modes(const scene::Body& body, MPI_Comm comm);

/// The kernel of a body whose file holds modes (docs/interchange.md), on rank 0; elsewhere an empty one.
/// Rigid modes of a free body are made from its mass and inertia; nothing proves that no other mode is
/// missing, and the certificate says so. Needs a GmshSession. Collective. Throws InputError on every rank:
/// another layout, less in the file than the scene asks for, five or seven rigid modes.
kernels::Kernel kernel_of_modes(const scene::KernelRequest& request, MPI_Comm comm,
                                console::Console& console);

}  // namespace ricochet
