// SPDX-License-Identifier: BSD-2-Clause
// Meshes that gmsh split into one file a part, read in parallel.
#pragma once

#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// Reads the parts of `body`'s mesh (scene::part_files) and hands each rank of `team` the elements that touch
/// its nodes. No rank holds more than its share of the parts, but the surfaces of all parts on rank 0: ranks
/// without a part only take part in what follows. Needs a GmshSession. Collective.
/// Throws InputError on every rank: what read_mesh throws, parts that do not fit together, a rod.
Mesh read_parts(const scene::Body& body, MPI_Comm team, const parallel::Progress& progress = {},
                const Asked& asked = {});

}  // namespace ricochet::mesh
