// SPDX-License-Identifier: BSD-2-Clause
// Reads in parallel a mesh that gmsh saved as one file per part.
#pragma once

#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// Reads the parts of the mesh of `body` (scene::part_files) and sends to each rank of `team` the elements
/// that touch its nodes. Each rank reads only its share of the parts; rank 0 also holds the surfaces of all
/// parts. Ranks without a part must call this function too. Needs a GmshSession. Collective.
/// Throws InputError on every rank for the reasons of read_mesh, and if the parts do not fit together or the
/// body is a rod.
Mesh read_parts(const scene::Body& body, MPI_Comm team, const parallel::Progress& progress = {},
                const RequestedGroups& asked = {});

}  // namespace ricochet::mesh
