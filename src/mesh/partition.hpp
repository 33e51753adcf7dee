// SPDX-License-Identifier: BSD-2-Clause
// Distributes a mesh from one rank over all ranks.
#pragma once

#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// Copies the facets of the first rank of `comm` to its other ranks. Collective.
void broadcast(FacetMesh& facets, MPI_Comm comm);

/// Copies the mesh of the first rank of `comm` to its other ranks. Collective.
void broadcast(GlobalMesh& global, MPI_Comm comm);

/// Splits the mesh on rank 0 and sends each rank its part. Only the `global` of rank 0 is used. Collective.
/// @param peers  ranks in the same place of other teams, which get the same part
Mesh distribute(GlobalMesh&& global, MPI_Comm comm, MPI_Comm peers = MPI_COMM_SELF);

}  // namespace ricochet::mesh
