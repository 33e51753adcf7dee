// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/mesh: from the parts of all ranks to a distributed mesh with global node numbers.
#pragma once

#include "src/mesh/part.hpp"
#include "src/mesh/send.hpp"

namespace ricochet::mesh {

/// Sets the tags of the nodes of a part whose blocks identify nodes by tags, and the indices in its blocks.
void collect_tags(Part& part);

/// Numbers nodes by owner, then by tag. The owner of a node is the lowest rank whose part contains it.
/// Collective.
Nodes number_nodes(const Part& part, MPI_Comm comm);

/// Sends each rank the elements that touch its nodes. Sets all of a mesh except dim, axis, the facets and the
/// pieces. Collective.
Mesh numbered(const Part& part, const Nodes& nodes, MPI_Comm comm);

/// Returns facets with the global numbers and positions of their nodes, on every rank. `blocks` identify
/// nodes by tags and are empty except on rank 0; the blocks of the result hold indices and stay there.
/// Collective; throws `foreign` on every rank if no part contains a node.
FacetMesh numbered(std::vector<Block> blocks, const Part& part, const Nodes& nodes, MPI_Comm comm,
                   const InputError& foreign);

}  // namespace ricochet::mesh
