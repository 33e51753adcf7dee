// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/partition.hpp"

#include <metis.h>

#include <algorithm>
#include <numeric>
#include <tuple>

#include "src/mesh/connected.hpp"
#include "src/parallel/parallel.hpp"

namespace ricochet::mesh {

namespace {

using parallel::broadcast;
using parallel::scatter;

/// Rank of each element, in the order of the blocks: METIS on the dual graph of the corners.
std::vector<idx_t> partition(const GlobalMesh& mesh, int ranks) {
  std::vector<idx_t> start{0}, corner;
  int shared = mesh.dim == 1 ? 1 : 3;  // corners that neighbours share: at least a triangle
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
  if (parts < 2) return part;
  idx_t common = shared;
  if (METIS_PartMeshDual(&elements, &nodes, start.data(), corner.data(), nullptr, nullptr, &common, &parts,
                         nullptr, nullptr, &cut, part.data(), node_part.data()) != METIS_OK)
    throw InputError("METIS could not split the mesh: run on fewer ranks");
  return part;
}

/// Data that rank 0 sends to each rank.
struct Parcels {
  explicit Parcels(int ranks)
      : header(ranks), node(ranks), canonical(ranks), fixed(ranks), part(ranks), position(ranks) {}
  std::vector<std::vector<std::int64_t>> header, node, canonical, fixed, part;
  std::vector<std::vector<double>> position;
};

/// Global numbers (owners in rank order, then reading order) and the first number of each rank.
struct Numbering {
  std::vector<std::int64_t> number;  ///< (n) by reading order
  std::vector<int> owner;            ///< (n)
  std::vector<std::int64_t> first;   ///< (ranks + 1)
};

Numbering number_nodes(const GlobalMesh& mesh, const std::vector<idx_t>& part, int ranks) {
  Numbering numbering;
  const std::size_t n = mesh.fixed.size();
  numbering.owner.assign(n, ranks);
  std::size_t element = 0;
  for (const Block& block : mesh.blocks)
    for (std::size_t e = 0; e < block.size(); ++e, ++element)
      for (int k = 0; k < block.nodes_per_element; ++k) {
        int& owner = numbering.owner[static_cast<std::size_t>(block.node[e * block.nodes_per_element + k])];
        owner = std::min(owner, static_cast<int>(part[element]));
      }
  // Bodies given by matrices have no elements; their nodes are distributed evenly.
  for (std::size_t i = 0; i < n && mesh.blocks.empty(); ++i)
    numbering.owner[i] = static_cast<int>(i * static_cast<std::size_t>(ranks) / n);
  numbering.first.assign(static_cast<std::size_t>(ranks) + 1, 0);
  for (int owner : numbering.owner) ++numbering.first[static_cast<std::size_t>(owner) + 1];
  std::partial_sum(numbering.first.begin(), numbering.first.end(), numbering.first.begin());
  std::vector<std::int64_t> next(numbering.first.begin(), numbering.first.end() - 1);
  numbering.number.resize(n);
  for (std::size_t i = 0; i < n; ++i)
    numbering.number[i] = next[static_cast<std::size_t>(numbering.owner[i])]++;
  return numbering;
}

/// Index of the connected part of each node (n), ordered by first nodes; and the number of parts.
std::pair<std::vector<std::int64_t>, std::int64_t> connected_parts(const GlobalMesh& mesh) {
  std::vector<std::int64_t> part = first_connected(mesh.fixed.size(), mesh.blocks);
  std::int64_t parts = 0;
  for (std::size_t i = 0; i < part.size(); ++i) {
    const auto first = static_cast<std::size_t>(part[i]);
    part[i] = first == i ? parts++ : part[first];
  }
  return {std::move(part), parts};
}

void renumber(FacetMesh& facets, const GlobalMesh& mesh, const Numbering& numbering, bool normals) {
  std::vector<std::int64_t> used;
  for (const Block& block : facets.blocks) used.insert(used.end(), block.node.begin(), block.node.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  std::vector<double> end_normal;
  facets.node.clear();
  facets.position.clear();
  for (std::int64_t node : used) {
    facets.node.push_back(numbering.number[static_cast<std::size_t>(node)]);
    for (int c = 0; c < 3; ++c)
      facets.position.push_back(mesh.position[3 * static_cast<std::size_t>(node) + c]);
    if (normals)
      for (int c = 0; c < 3; ++c)
        end_normal.push_back(facets.end_normal[3 * static_cast<std::size_t>(node) + c]);
  }
  facets.end_normal = end_normal;
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
  std::vector<double> axis(global.axis.begin(), global.axis.end());
  std::vector<std::int64_t> header{global.dim, global.order}, fixed(global.fixed.begin(), global.fixed.end());
  broadcast(comm, axis);
  broadcast(comm, header);
  broadcast(comm, fixed);
  std::copy(axis.begin(), axis.end(), global.axis.begin());
  global.dim = static_cast<int>(header[0]);
  global.order = static_cast<int>(header[1]);
  global.fixed.assign(fixed.begin(), fixed.end());
  broadcast(comm, global.position);
  broadcast_blocks(global.blocks, comm);
  broadcast(global.contact, comm);
  broadcast(global.loaded, comm);
  broadcast(global.visualisation, comm);
}

Mesh distribute(GlobalMesh&& global, MPI_Comm comm) {
  const int ranks = parallel::size_of(comm), me = parallel::rank_of(comm);
  Mesh mesh;
  mesh.comm = comm;
  std::vector<idx_t> part;
  std::vector<std::int64_t> connected;
  Numbering numbering;
  Parcels parcels(ranks);
  std::vector<std::int64_t> types;

  parallel::on_first_rank(comm, [&] {
    part = partition(global, ranks);
    numbering = number_nodes(global, part, ranks);
    std::int64_t parts = 0;
    std::tie(connected, parts) = connected_parts(global);
    for (int r = 0; r < ranks; ++r)
      parcels.header[r] = {global.dim,
                           global.order,
                           numbering.first[r],
                           numbering.first[r + 1] - numbering.first[r],
                           static_cast<std::int64_t>(global.fixed.size()),
                           static_cast<std::int64_t>(part.size()),
                           parts};
    for (const Block& block : global.blocks)
      types.insert(types.end(), {block.gmsh_type, block.nodes_per_element});
    renumber(global.contact, global, numbering, !global.contact.end_normal.empty());
    renumber(global.loaded, global, numbering, !global.loaded.end_normal.empty());
    renumber(global.visualisation, global, numbering, false);
  });
  const auto header = scatter(comm, parcels.header);
  mesh.dim = static_cast<int>(header[0]);
  mesh.order = static_cast<int>(header[1]);
  mesh.first_node = header[2];
  mesh.owned_nodes = header[3];
  mesh.total_nodes = header[4];
  mesh.total_elements = header[5];
  mesh.parts = header[6];
  std::vector<double> axis(global.axis.begin(), global.axis.end());
  broadcast(comm, axis);
  std::copy(axis.begin(), axis.end(), mesh.axis.begin());
  broadcast(comm, types);

  // An element goes to every rank that owns one of its nodes, and to the rank of its partition.
  std::vector<std::vector<std::int64_t>> used(ranks);
  std::size_t offset = 0;
  for (std::size_t b = 0; b < types.size() / 2; ++b) {
    std::vector<std::vector<std::int64_t>> node(ranks), tag(ranks), label(ranks), own(ranks);
    if (me == 0) {
      const Block& block = global.blocks[b];
      const auto width = static_cast<std::size_t>(block.nodes_per_element);
      std::vector<int> takers;
      for (std::size_t e = 0; e < block.size(); ++e) {
        takers.assign(1, static_cast<int>(part[offset + e]));
        for (std::size_t k = 0; k < width; ++k)
          takers.push_back(numbering.owner[static_cast<std::size_t>(block.node[e * width + k])]);
        std::sort(takers.begin(), takers.end());
        takers.erase(std::unique(takers.begin(), takers.end()), takers.end());
        for (int r : takers) {
          for (std::size_t k = 0; k < width; ++k) node[r].push_back(block.node[e * width + k]);
          tag[r].push_back(block.tag[e]);
          label[r].push_back(block.label[e]);
          own[r].push_back(r == part[offset + e]);
        }
      }
      offset += block.size();
      for (int r = 0; r < ranks; ++r) used[r].insert(used[r].end(), node[r].begin(), node[r].end());
    }
    Block block{static_cast<int>(types[2 * b]), static_cast<int>(types[2 * b + 1]), scatter(comm, node),
                scatter(comm, tag), scatter(comm, label)};
    mesh.blocks.push_back(std::move(block));
    mesh.own.push_back(scatter(comm, own));
  }

  if (me == 0 && global.blocks.empty())
    for (std::size_t n = 0; n < numbering.owner.size(); ++n)
      used[numbering.owner[n]].push_back(static_cast<std::int64_t>(n));
  if (me == 0)
    for (int r = 0; r < ranks; ++r) {
      auto& nodes = used[r];
      std::sort(nodes.begin(), nodes.end());
      nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
      std::sort(nodes.begin(), nodes.end(),
                [&](auto x, auto y) { return numbering.number[x] < numbering.number[y]; });
      for (std::int64_t n : nodes) {
        parcels.node[r].push_back(numbering.number[n]);
        parcels.canonical[r].push_back(n);
        parcels.fixed[r].push_back(global.fixed[n]);
        parcels.part[r].push_back(connected[static_cast<std::size_t>(n)]);
        for (int c = 0; c < 3; ++c) parcels.position[r].push_back(global.position[3 * n + c]);
      }
    }
  mesh.node = scatter(comm, parcels.node);
  mesh.canonical = scatter(comm, parcels.canonical);
  mesh.fixed = scatter(comm, parcels.fixed);
  mesh.part = scatter(comm, parcels.part);
  mesh.position = scatter(comm, parcels.position);

  // Elements still refer to nodes by reading order; convert that to local numbers.
  std::vector<std::pair<std::int64_t, std::int64_t>> local;
  for (std::size_t i = 0; i < mesh.canonical.size(); ++i)
    local.emplace_back(mesh.canonical[i], static_cast<std::int64_t>(i));
  std::sort(local.begin(), local.end());
  for (Block& block : mesh.blocks)
    for (std::int64_t& node : block.node)
      node = std::lower_bound(local.begin(), local.end(), std::pair<std::int64_t, std::int64_t>{node, -1})
                 ->second;

  mesh.contact = std::move(global.contact);
  broadcast(mesh.contact, comm);
  mesh.loaded = std::move(global.loaded);
  broadcast(mesh.loaded, comm);
  mesh.visualisation = std::move(global.visualisation);
  return mesh;
}

}  // namespace ricochet::mesh
