// SPDX-License-Identifier: BSD-2-Clause
// Connected parts of a mesh or of a matrix.
#pragma once

#include <cstdint>
#include <vector>

#include "src/mesh/directory.hpp"
#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// Connected components of a graph, by union-find with path halving.
class Connections {
 public:
  explicit Connections(std::size_t nodes);
  void join(std::int64_t a, std::int64_t b);
  /// Returns the lowest node that edges connect to `node`.
  std::int64_t first(std::int64_t node);

 private:
  std::vector<std::int64_t> root_;
};

/// Returns, for each node, the lowest node to which elements connect it.
std::vector<std::int64_t> first_connected(std::size_t nodes, const std::vector<Block>& blocks);

/// Returns, for each entity of this rank, the lowest tag of those to which connections on any rank lead. This
/// is repeated until no rank receives a lower tag from another one. Collective.
/// @param tags, directory  of the entities, @param first  the entity of this rank to which connections on
/// this rank lead, the same for all that are connected there
std::vector<std::int64_t> lowest_connected(MPI_Comm comm, const Directory& directory,
                                           const std::vector<std::int64_t>& tags,
                                           const std::vector<std::int64_t>& first);

}  // namespace ricochet::mesh
