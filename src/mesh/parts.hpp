// SPDX-License-Identifier: BSD-2-Clause
// Meshes that gmsh saved as one file per part, read in parallel.
#pragma once

#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// Reads the parts of the mesh of `body` (scene::part_files) and sends each rank of `team` the elements that
/// touch its nodes. Each rank holds its share of the parts only; rank 0 also holds the surfaces of all parts.
/// Ranks without a part take part in the communication. Needs a GmshSession. Collective.
/// Throws InputError on every rank: the errors of read_mesh, parts that do not fit together, a rod.
Mesh read_parts(const scene::Body& body, MPI_Comm team, const parallel::Progress& progress = {},
                const RequestedGroups& asked = {});

}  // namespace ricochet::mesh
