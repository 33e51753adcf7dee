// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/parts.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "src/mesh/complaints.hpp"
#include "src/mesh/number.hpp"
#include "src/mesh/partition.hpp"
#include "src/mesh/pieces.hpp"
#include "src/mesh/share.hpp"

namespace ricochet::mesh {

namespace {

using parallel::gather;

/// Gathers the boundary faces of all ranks on rank 0, with nodes identified by tags, and removes faces
/// between two parts. Collective.
Faces gather_outside(MPI_Comm comm, const Part& share) {
  // A triangle has fewer nodes than a quadrangle, and −1 in place of the others.
  const auto width = static_cast<std::ptrdiff_t>((share.order + 1) * (share.order + 1));
  Numbers packed;
  for (const auto& [corners, nodes] : share.outside) {
    for (const std::int64_t node : nodes) packed.push_back(share.tag[static_cast<std::size_t>(node)]);
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
std::vector<Block> gather_facets(MPI_Comm comm, std::vector<Block> blocks) {
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

/// Collects the surfaces of the complete body: contact and loaded surfaces on every rank, the visualisation
/// surface on rank 0.
void collect_surfaces(MPI_Comm comm, const scene::Body& body, const Part& share, const Nodes& nodes,
                      Mesh& mesh) {
  const Faces outside = gather_outside(comm, share);
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
    *facets = numbered(std::move(*blocks), share, nodes, comm, foreign_nodes(body));
    broadcast(*facets, comm);
  }
  mesh.visualisation = numbered(std::move(visualisation), share, nodes, comm, foreign_nodes(body));
  if (parallel::rank_of(comm) != 0) mesh.visualisation = {};
}

}  // namespace

Mesh read_msh(const MshFiles& files, const scene::Body& body, MPI_Comm team, MPI_Comm peers,
              const parallel::Progress& progress, const RequestedGroups& asked) {
  const Part share = read_share(files, body, asked, team, peers, progress);
  const Nodes nodes = number_nodes(share, team);
  Mesh mesh = numbered(share, nodes, team);
  collect_surfaces(team, body, share, nodes, mesh);
  find_pieces(mesh);
  return mesh;
}

}  // namespace ricochet::mesh
