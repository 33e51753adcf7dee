// SPDX-License-Identifier: BSD-2-Clause
// From the whole mesh on one rank to a part on each rank.
#pragma once

#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// Copies the facets of the first rank of `comm` to its other ranks. Collective.
void broadcast(FacetMesh& facets, MPI_Comm comm);

/// Copies the mesh of the first rank of `comm` to its other ranks. Collective.
void broadcast(GlobalMesh& global, MPI_Comm comm);

/// Partitions the mesh by METIS and sends each rank its part. `global` is used on rank 0 only. Collective.
Mesh distribute(GlobalMesh&& global, MPI_Comm comm);

}  // namespace ricochet::mesh
