// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/partition.hpp"

#include <algorithm>
#include <utility>

#include "src/mesh/number.hpp"
#include "src/mesh/pieces.hpp"
#include "src/mesh/split.hpp"

namespace ricochet::mesh {

namespace {

using parallel::broadcast;

/// Sends an equal share of the elements on rank 0 to each rank, with nodes by index, and forgets them there.
std::vector<Block> shares_of(std::vector<Block> blocks, MPI_Comm comm) {
  Numbers types, rank;
  std::int64_t elements = 0;
  for (const Block& block : blocks) {
    types.insert(types.end(), {block.gmsh_type, block.nodes_per_element});
    elements += std::ssize(block.tag);
  }
  for (std::int64_t e = 0; e < elements; ++e) rank.push_back(e * parallel::size_of(comm) / elements);
  broadcast(comm, types);
  // The other ranks contribute empty blocks of the same types.
  for (std::size_t k = 0; parallel::rank_of(comm) > 0 && k < types.size(); k += 2)
    blocks.push_back({static_cast<int>(types[k]), static_cast<int>(types[k + 1]), {}, {}, {}});
  return exchanged(blocks, rank, comm);
}

/// Takes the positions and supports of the nodes of a part from rank 0.
void take_nodes_from_first(Part& part, const GlobalMesh& global, MPI_Comm comm) {
  std::vector<Numbers> asked(static_cast<std::size_t>(parallel::size_of(comm))), fixed(asked.size());
  std::vector<std::vector<double>> position(asked.size());
  asked[0] = part.tag;
  asked = parallel::exchange(comm, asked);
  for (std::size_t r = 0; r < asked.size(); ++r)
    for (const std::int64_t node : asked[r]) {
      const auto n = static_cast<std::size_t>(node);
      fixed[r].push_back(global.fixed[n]);
      position[r].insert(position[r].end(), &global.position[3 * n], &global.position[3 * n] + 3);
    }
  part.fixed = parallel::exchange(comm, fixed)[0];
  part.position = parallel::exchange(comm, position)[0];
}

/// The part of each rank. The tags of nodes are their indices on rank 0. Collective.
Part part_of(GlobalMesh& global, MPI_Comm comm, MPI_Comm peers) {
  Part part;
  part.order = parallel::of_rank(comm, 0, global.order);
  part.blocks = split(shares_of(std::exchange(global.blocks, {}), comm), comm, peers);
  collect_tags(part);
  // Bodies given by matrices have no elements; their nodes are distributed evenly.
  const std::int64_t nodes = parallel::of_rank(comm, 0, std::ssize(global.fixed)),
                     ranks = parallel::size_of(comm), me = parallel::rank_of(comm);
  for (std::int64_t n = nodes * me / ranks; part.blocks.empty() && n < nodes * (me + 1) / ranks; ++n)
    part.tag.push_back(n);
  take_nodes_from_first(part, global, comm);
  global.position = {};
  global.fixed = {};
  return part;
}

/// Facets on rank 0 with the global numbers of their nodes, on rank 0. Collective.
FacetMesh numbered_facets(FacetMesh facets, const Part& part, const Nodes& nodes, MPI_Comm comm) {
  Numbers used;
  for (const Block& block : facets.blocks) used.insert(used.end(), block.node.begin(), block.node.end());
  sort_once(used);
  std::vector<double> end_normal;
  for (const std::int64_t node : used)
    for (std::size_t c = 0; c < 3 && !facets.end_normal.empty(); ++c)
      end_normal.push_back(facets.end_normal[3 * static_cast<std::size_t>(node) + c]);
  FacetMesh out = numbered(std::move(facets.blocks), part, nodes, comm,
                           InputError("internal: a facet has a node that is not the body's"));
  out.end_normal = std::move(end_normal);
  return out;
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

Mesh distribute(GlobalMesh&& global, MPI_Comm comm, MPI_Comm peers) {
  if (parallel::rank_of(comm) > 0) global = {};
  const Part part = part_of(global, comm, peers);
  const Nodes nodes = number_nodes(part, comm);
  Mesh mesh = numbered(part, nodes, comm);
  mesh.dim = parallel::of_rank(comm, 0, global.dim);
  mesh.axis = parallel::of_rank(comm, 0, global.axis);
  mesh.contact = numbered_facets(std::move(global.contact), part, nodes, comm);
  broadcast(mesh.contact, comm);
  mesh.loaded = numbered_facets(std::move(global.loaded), part, nodes, comm);
  broadcast(mesh.loaded, comm);
  mesh.visualisation = numbered_facets(std::move(global.visualisation), part, nodes, comm);
  if (parallel::rank_of(comm) > 0) mesh.visualisation = {};
  find_pieces(mesh);
  return mesh;
}

}  // namespace ricochet::mesh
