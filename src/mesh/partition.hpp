// SPDX-License-Identifier: BSD-2-Clause
// Distributes a mesh from one rank over all ranks.
#pragma once

#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// Copies the facets of the first rank of `comm` to its other ranks. Collective.
void broadcast(FacetMesh& facets, MPI_Comm comm);

/// Copies the mesh of the first rank of `comm` to its other ranks. Collective.
void broadcast(GlobalMesh& global, MPI_Comm comm);

/// Partitions the mesh with METIS and sends each rank its part. Only the `global` of rank 0 is used.
/// Collective.
Mesh distribute(GlobalMesh&& global, MPI_Comm comm);

}  // namespace ricochet::mesh
