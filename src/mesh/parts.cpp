// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/parts.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "src/mesh/complaints.hpp"
#include "src/mesh/connected.hpp"
#include "src/mesh/directory.hpp"
#include "src/mesh/partition.hpp"
#include "src/mesh/pieces.hpp"
#include "src/mesh/send.hpp"
#include "src/mesh/share.hpp"

namespace ricochet::mesh {

namespace {

using parallel::broadcast;
using parallel::gather;

/// Returns the distinct values of all ranks, in ascending order, on every rank. Collective.
Numbers united(MPI_Comm comm, const Numbers& mine) {
  Numbers all = gather(comm, mine);
  sort_once(all);
  broadcast(comm, all);
  return all;
}

/// Returns one block for each element type that any rank has, in the same order on every rank. Blocks of
/// types that this rank does not have are empty. Collective.
std::vector<Block> same_types(MPI_Comm comm, const std::vector<Block>& blocks) {
  Numbers types;
  for (const Block& block : blocks) types.push_back(block.gmsh_type);
  std::vector<Block> all;
  for (std::int64_t type : united(comm, types)) {
    const int gmsh_type = static_cast<int>(type);
    const auto mine = std::ranges::find(blocks, gmsh_type, &Block::gmsh_type);
    all.push_back(mine != blocks.end() ? *mine
                                       : Block{gmsh_type, reference_element(gmsh_type).nodes, {}, {}, {}});
  }
  return all;
}

/// Finds the connected parts of the body.
void find_connected_parts(MPI_Comm comm, const Part& share, const Directory& directory, Nodes& nodes) {
  Numbers& lowest = nodes.part =
      lowest_connected(comm, directory, share.tag, first_connected(share.tag.size(), share.blocks));
  Numbers firsts;
  for (std::size_t n = 0; n < lowest.size(); ++n)
    if (lowest[n] == share.tag[n]) firsts.push_back(lowest[n]);
  firsts = united(comm, firsts);
  nodes.parts = static_cast<std::int64_t>(firsts.size());
  for (std::int64_t& part : lowest)
    part = std::lower_bound(firsts.begin(), firsts.end(), part) - firsts.begin();
}

/// Numbers nodes by owner, then by tag. The owner of a node is the lowest rank that read it.
Nodes number_nodes(MPI_Comm comm, const Part& share) {
  const std::int64_t me = parallel::rank_of(comm);
  const Directory directory(comm, share.tag);
  Nodes nodes;
  nodes.owner =
      directory.combined(Numbers(share.tag.size(), me), [](auto a, auto b) { return std::min(a, b); });
  // If a part touches a support only at a corner, its file contains no facet of the support.
  nodes.fixed = directory.combined(share.fixed, [](auto a, auto b) { return a | b; });
  nodes.owned = std::count(nodes.owner.begin(), nodes.owner.end(), me);
  nodes.total = parallel::sum(comm, nodes.owned);
  nodes.first = parallel::sum_before(comm, nodes.owned);
  std::int64_t next = nodes.first;
  Numbers number(share.tag.size(), -1);
  for (std::size_t n = 0; n < number.size(); ++n)
    if (nodes.owner[n] == me) number[n] = next++;
  nodes.number = directory.combined(number, [](auto a, auto b) { return std::max(a, b); });
  nodes.canonical = directory.order();
  find_connected_parts(comm, share, directory, nodes);
  return nodes;
}

/// Gathers the boundary faces of all ranks on rank 0 and removes faces between two parts. Collective.
/// @param order  of the elements
Faces gather_outside(MPI_Comm comm, const Faces& mine, int order) {
  // A triangle has fewer nodes than a quadrangle, and −1 in place of the others.
  const auto width = static_cast<std::ptrdiff_t>((order + 1) * (order + 1));
  Numbers packed;
  for (const auto& [corners, nodes] : mine) {
    packed.insert(packed.end(), nodes.begin(), nodes.end());
    packed.insert(packed.end(), static_cast<std::size_t>(width) - nodes.size(), -1);
  }
  packed = gather(comm, packed);
  Faces outside;
  for (auto at = packed.begin(); at != packed.end(); at += width) {
    const auto end = std::find(at, at + width, -1);
    add_face(outside, Corners(at, at + (end == at + width ? 4 : 3)), FaceNodes(at, end));
  }
  return outside;
}

/// Gathers the facets of all ranks on rank 0, in the order of their tags and with nodes identified by tags. A
/// facet that touches another part may occur in both files; it is kept once. Collective.
std::vector<Block> gather_facets(MPI_Comm comm, const std::vector<Block>& mine) {
  std::vector<Block> blocks = same_types(comm, mine);
  for (Block& block : blocks) {
    const Block all{block.gmsh_type, block.nodes_per_element, gather(comm, block.node),
                    gather(comm, block.tag), gather(comm, block.label)};
    block.node.clear();
    block.tag.clear();
    block.label.clear();
    std::vector<std::size_t> order(all.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](auto a, auto b) {
      return std::pair{all.tag[a], all.label[a]} < std::pair{all.tag[b], all.label[b]};
    });
    for (std::size_t e : order) {
      if (!block.tag.empty() && block.tag.back() == all.tag[e] && block.label.back() == all.label[e])
        continue;
      const auto nodes = all.node.begin() + static_cast<std::ptrdiff_t>(e * all.nodes_per_element);
      block.node.insert(block.node.end(), nodes, nodes + all.nodes_per_element);
      block.tag.push_back(all.tag[e]);
      block.label.push_back(all.label[e]);
    }
  }
  return blocks;
}

/// Returns facets with the global numbers and positions of their nodes, on every rank. `blocks` identify
/// nodes by tags and are empty except on rank 0; the blocks of the result hold indices. Collective.
FacetMesh numbered(std::vector<Block> blocks, const scene::Body& body, const Part& share, const Nodes& nodes,
                   MPI_Comm comm) {
  Numbers tags;
  for (const Block& block : blocks) tags.insert(tags.end(), block.node.begin(), block.node.end());
  tags = united(comm, tags);
  for (Block& block : blocks)
    for (std::int64_t& node : block.node)
      node = std::lower_bound(tags.begin(), tags.end(), node) - tags.begin();
  // Only the owner of a node contributes its values: number, position and 1.
  constexpr std::size_t width = 5;
  std::vector<double> values(width * tags.size(), 0);
  for (std::size_t i = 0; i < tags.size(); ++i) {
    const auto n = static_cast<std::size_t>(std::lower_bound(share.tag.begin(), share.tag.end(), tags[i]) -
                                            share.tag.begin());
    if (n == share.tag.size() || share.tag[n] != tags[i] || nodes.owner[n] != parallel::rank_of(comm))
      continue;
    double* value = &values[width * i];
    value[0] = static_cast<double>(nodes.number[n]);
    std::copy_n(&share.position[3 * n], 3, value + 1);
    value[4] = 1;
  }
  parallel::sum(comm, values);
  FacetMesh facets;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    const double* value = &values[width * i];
    if (value[4] == 0) throw foreign_nodes(body);
    facets.node.push_back(static_cast<std::int64_t>(value[0]));
    facets.position.insert(facets.position.end(), value + 1, value + 4);
  }
  facets.blocks = std::move(blocks);
  return facets;
}

/// Collects the surfaces of the complete body: contact and loaded surfaces on every rank, the visualisation
/// surface on rank 0.
void collect_surfaces(MPI_Comm comm, const scene::Body& body, const Part& share, const Nodes& nodes,
                      Mesh& mesh) {
  const Faces outside = gather_outside(comm, share.outside, mesh.order);
  std::vector<Block> contact = gather_facets(comm, share.contact), loaded = gather_facets(comm, share.loaded),
                     visualisation;
  parallel::on_first_rank(comm, [&] {
    if (share.touches_everywhere)  // without the faces between parts
      for (Block& block : contact) keep_outside(block, outside);
    refuse_repeated(contact, "facet", "contact", body);
    for (Block& block : contact) orient(block, mesh.order, outside, body, "bodies." + body.name + ".contact");
    for (Block& block : loaded) orient(block, mesh.order, outside, body, traction_key);
    visualisation = triangles_of(outside, mesh.order);
  });
  for (auto [blocks, facets] : {std::pair{&contact, &mesh.contact}, std::pair{&loaded, &mesh.loaded}}) {
    if (parallel::rank_of(comm) != 0) blocks->clear();
    *facets = numbered(std::move(*blocks), body, share, nodes, comm);
    broadcast(*facets, comm);
  }
  mesh.visualisation = numbered(std::move(visualisation), body, share, nodes, comm);
  if (parallel::rank_of(comm) != 0) mesh.visualisation = {};
}

}  // namespace

Mesh read_parts(const scene::Body& body, MPI_Comm team, const parallel::Progress& progress,
                const RequestedGroups& asked) {
  const Part share = read_share(body, asked, team, progress);
  const Nodes nodes = number_nodes(team, share);
  Mesh mesh;
  mesh.comm = team;
  mesh.order = static_cast<int>(parallel::largest(team, share.order));
  std::size_t elements = 0;
  for (const Block& block : share.blocks) elements += block.size();
  send(same_types(team, share.blocks), Numbers(elements, parallel::rank_of(team)), share.position, nodes,
       mesh);
  collect_surfaces(team, body, share, nodes, mesh);
  find_pieces(mesh);
  return mesh;
}

}  // namespace ricochet::mesh
