// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/partition.hpp"

#include <metis.h>

#include <algorithm>
#include <numeric>
#include <tuple>

#include "src/mesh/connected.hpp"
#include "src/mesh/pieces.hpp"
#include "src/mesh/send.hpp"

namespace ricochet::mesh {

namespace {

using parallel::broadcast;

/// Returns the rank of each element, in the order of the blocks. METIS partitions the dual graph that the
/// corners define.
Numbers partition(const GlobalMesh& mesh, int ranks) {
  std::vector<idx_t> start{0}, corner;
  for (const Block& block : mesh.blocks) {
    const int corners = reference_element(block.gmsh_type).corners;
    for (std::size_t e = 0; e < block.size(); ++e) {
      for (int c = 0; c < corners; ++c)
        corner.push_back(static_cast<idx_t>(block.node[e * block.nodes_per_element + c]));
      start.push_back(static_cast<idx_t>(corner.size()));
    }
  }
  idx_t elements = static_cast<idx_t>(start.size()) - 1, nodes = static_cast<idx_t>(mesh.fixed.size()),
        cut = 0;
  idx_t parts = std::min<idx_t>(ranks, elements);
  std::vector<idx_t> part(static_cast<std::size_t>(elements), 0), node_part(static_cast<std::size_t>(nodes));
  if (parts < 2) return Numbers(part.size(), 0);
  idx_t common = mesh.dim == 1 ? 1 : 3;  // corners that neighbours must share: in a solid, a triangle
  if (METIS_PartMeshDual(&elements, &nodes, start.data(), corner.data(), nullptr, nullptr, &common, &parts,
                         nullptr, nullptr, &cut, part.data(), node_part.data()) != METIS_OK)
    throw InputError("METIS could not split the mesh: run on fewer ranks");
  return {part.begin(), part.end()};
}

/// Sets the owners of the nodes, and numbers the nodes by owner, then in reading order.
/// @return (ranks + 1) the first number of each rank, followed by the number of nodes
Numbers number_nodes(const GlobalMesh& mesh, const Numbers& part, int ranks, Nodes& nodes) {
  const std::size_t n = mesh.fixed.size();
  nodes.owner.assign(n, ranks);
  std::size_t element = 0;
  for (const Block& block : mesh.blocks)
    for (std::size_t e = 0; e < block.size(); ++e, ++element)
      for (int k = 0; k < block.nodes_per_element; ++k) {
        std::int64_t& owner =
            nodes.owner[static_cast<std::size_t>(block.node[e * block.nodes_per_element + k])];
        owner = std::min(owner, part[element]);
      }
  // Bodies given by matrices have no elements; their nodes are distributed evenly.
  for (std::size_t i = 0; i < n && mesh.blocks.empty(); ++i)
    nodes.owner[i] = static_cast<std::int64_t>(i * static_cast<std::size_t>(ranks) / n);
  Numbers first(static_cast<std::size_t>(ranks) + 1, 0);
  for (const std::int64_t owner : nodes.owner) ++first[static_cast<std::size_t>(owner) + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  Numbers next = first;
  for (const std::int64_t owner : nodes.owner)
    nodes.number.push_back(next[static_cast<std::size_t>(owner)]++);
  return first;
}

/// Returns the index of the connected part of each node (n), and the number of parts. Parts are ordered by
/// their first nodes.
std::pair<Numbers, std::int64_t> connected_parts(const GlobalMesh& mesh) {
  Numbers part = first_connected(mesh.fixed.size(), mesh.blocks);
  std::int64_t parts = 0;
  for (std::size_t i = 0; i < part.size(); ++i) {
    const auto first = static_cast<std::size_t>(part[i]);
    part[i] = first == i ? parts++ : part[first];
  }
  return {std::move(part), parts};
}

/// Restricts the nodes to those of the facets, with their global numbers.
void renumber(FacetMesh& facets, const GlobalMesh& mesh, const Numbers& number) {
  Numbers used;
  for (const Block& block : facets.blocks) used.insert(used.end(), block.node.begin(), block.node.end());
  sort_once(used);
  std::vector<double> end_normal;
  facets.node.clear();
  facets.position.clear();
  for (std::int64_t node : used) {
    const auto n = static_cast<std::size_t>(node);
    facets.node.push_back(number[n]);
    facets.position.insert(facets.position.end(), &mesh.position[3 * n], &mesh.position[3 * n] + 3);
    if (!facets.end_normal.empty())
      end_normal.insert(end_normal.end(), &facets.end_normal[3 * n], &facets.end_normal[3 * n] + 3);
  }
  facets.end_normal = std::move(end_normal);
  for (Block& block : facets.blocks)
    for (std::int64_t& node : block.node)
      node = std::lower_bound(used.begin(), used.end(), node) - used.begin();
}

void broadcast_blocks(std::vector<Block>& blocks, MPI_Comm comm) {
  std::vector<std::int64_t> header;
  for (const Block& block : blocks) header.insert(header.end(), {block.gmsh_type, block.nodes_per_element});
  broadcast(comm, header);
  blocks.resize(header.size() / 2);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    blocks[b].gmsh_type = static_cast<int>(header[2 * b]);
    blocks[b].nodes_per_element = static_cast<int>(header[2 * b + 1]);
    broadcast(comm, blocks[b].node);
    broadcast(comm, blocks[b].tag);
    broadcast(comm, blocks[b].label);
  }
}

}  // namespace

void broadcast(FacetMesh& facets, MPI_Comm comm) {
  broadcast(comm, facets.node);
  broadcast(comm, facets.position);
  broadcast(comm, facets.end_normal);
  broadcast_blocks(facets.blocks, comm);
}

void broadcast(GlobalMesh& global, MPI_Comm comm) {
  global.dim = parallel::of_rank(comm, 0, global.dim);
  global.order = parallel::of_rank(comm, 0, global.order);
  global.axis = parallel::of_rank(comm, 0, global.axis);
  broadcast(comm, global.fixed);
  broadcast(comm, global.position);
  broadcast_blocks(global.blocks, comm);
  broadcast(global.contact, comm);
  broadcast(global.loaded, comm);
  broadcast(global.visualisation, comm);
}

Mesh distribute(GlobalMesh&& global, MPI_Comm comm) {
  const int ranks = parallel::size_of(comm);
  Nodes nodes;
  Numbers part, first, types;
  parallel::on_first_rank(comm, [&] {
    part = partition(global, ranks);
    first = number_nodes(global, part, ranks, nodes);
    nodes.canonical.resize(global.fixed.size());
    std::iota(nodes.canonical.begin(), nodes.canonical.end(), 0);
    nodes.fixed = global.fixed;
    std::tie(nodes.part, nodes.parts) = connected_parts(global);
    for (const Block& block : global.blocks)
      types.insert(types.end(), {block.gmsh_type, block.nodes_per_element});
    for (FacetMesh* facets : {&global.contact, &global.loaded, &global.visualisation})
      renumber(*facets, global, nodes.number);
  });
  broadcast(comm, first);
  broadcast(comm, types);
  const auto me = static_cast<std::size_t>(parallel::rank_of(comm));
  nodes.first = first[me];
  nodes.owned = first[me + 1] - first[me];
  nodes.total = first.back();
  nodes.parts = parallel::of_rank(comm, 0, nodes.parts);
  Mesh mesh;
  mesh.comm = comm;
  mesh.dim = parallel::of_rank(comm, 0, global.dim);
  mesh.order = parallel::of_rank(comm, 0, global.order);
  mesh.axis = parallel::of_rank(comm, 0, global.axis);
  // The other ranks contribute empty blocks of the same types.
  if (me > 0) global = {};
  for (std::size_t k = 0; me > 0 && k < types.size(); k += 2)
    global.blocks.push_back({static_cast<int>(types[k]), static_cast<int>(types[k + 1]), {}, {}, {}});
  send(global.blocks, part, global.position, nodes, mesh);
  mesh.contact = std::move(global.contact);
  broadcast(mesh.contact, comm);
  mesh.loaded = std::move(global.loaded);
  broadcast(mesh.loaded, comm);
  mesh.visualisation = std::move(global.visualisation);
  find_pieces(mesh);
  return mesh;
}

}  // namespace ricochet::mesh
