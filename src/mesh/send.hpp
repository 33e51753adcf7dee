// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/mesh: elements and nodes from the ranks that read them to those that need them.
#pragma once

#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

using Numbers = std::vector<std::int64_t>;

/// The nodes that a rank read, and this rank's share of all nodes.
struct Nodes {
  Numbers owner;                           ///< (n) rank
  Numbers number, canonical, fixed, part;  ///< (n) as in Mesh; `number`: global
  std::int64_t first = 0, owned = 0, total = 0, parts = 0;
};

/// Sends the nodes and elements of all ranks to the ranks of `mesh.comm` that need them: elements to every
/// rank that owns one of their nodes. Sets all of `mesh` except dim, order, axis and the facets. Collective.
/// @param blocks    elements that this rank read, nodes by index; the same types on every rank
/// @param rank      of each element, which also receives it and counts it as its own
/// @param position  (n,3) of the nodes
void send(const std::vector<Block>& blocks, const Numbers& rank, const std::vector<double>& position,
          const Nodes& nodes, Mesh& mesh);

}  // namespace ricochet::mesh
