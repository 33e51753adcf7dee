// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/mesh: divides elements among ranks.
#pragma once

#include <vector>

#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// Moves each element to the rank that shall own it. PT-Scotch splits the graph of elements that share faces
/// into parts of equal size with few faces between them. Elements without faces, and very few elements, keep
/// their order instead. Collective.
/// @param blocks  elements of this rank, of the same types on every rank, with nodes numbered alike on all
/// ranks
/// @param peers   ranks in the same place of other teams, which have the same elements and get the same
std::vector<Block> split(const std::vector<Block>& blocks, MPI_Comm comm, MPI_Comm peers);

}  // namespace ricochet::mesh
