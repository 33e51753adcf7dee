// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/mesh: sends elements and nodes from the ranks that read them to the ranks that need them.
#pragma once

#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

using Numbers = std::vector<std::int64_t>;

/// The nodes that a rank has read, and the range of nodes that it owns.
struct Nodes {
  Numbers owner;                           ///< (n) rank
  Numbers number, canonical, fixed, part;  ///< (n) as in Mesh; `number`: global
  std::int64_t first = 0, owned = 0, total = 0, parts = 0;
};

/// Sends each element to one rank. Collective.
/// @param blocks  elements of this rank; all ranks have the same types
/// @param rank    for each element, in the order of the blocks
std::vector<Block> exchanged(const std::vector<Block>& blocks, const Numbers& rank, MPI_Comm comm);

/// Sends nodes and elements to the ranks of `mesh.comm` that need them. An element is sent to every rank that
/// owns one of its nodes. Sets all of `mesh` except dim, order, axis and the facets. Collective.
/// @param blocks    elements that this rank has read, with nodes by index; all ranks have the same types
/// @param rank      for each element, the rank on which it is `own`; this rank receives it too
/// @param position  (n,3) positions of the nodes [m]
void send(const std::vector<Block>& blocks, const Numbers& rank, const std::vector<double>& position,
          const Nodes& nodes, Mesh& mesh);

}  // namespace ricochet::mesh
