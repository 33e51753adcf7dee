// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/faces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "src/mesh/complaints.hpp"
#include "src/mesh/part.hpp"

namespace ricochet::mesh {

namespace {

Corners sorted(Corners corners) {
  std::sort(corners.begin(), corners.end());
  return corners;
}

/// Permutation of the nodes of a facet that mirrors it: the lattice position (i, j) becomes (j, i).
std::vector<int> mirrored(const ReferenceElement& reference) {
  std::vector<int> to(static_cast<std::size_t>(reference.nodes));
  for (int n = 0; n < reference.nodes; ++n)
    for (int k = 0; k < reference.nodes; ++k)
      if (std::abs(reference.node[2 * n] - reference.node[2 * k + 1]) +
              std::abs(reference.node[2 * n + 1] - reference.node[2 * k]) <
          1e-6)
        to[n] = k;
  return to;
}

}  // namespace

Faces outside_of(const std::vector<Block>& blocks) {
  struct Face {
    std::int64_t count = 0;
    Corners outward;
  };
  std::map<Corners, Face> faces;
  for (const Block& block : blocks) {
    const auto pattern = outward_faces(reference_element(block.gmsh_type).family);
    for (std::size_t e = 0; e < block.size(); ++e)
      for (const std::vector<int>& face : pattern) {
        Corners outward;
        for (int corner : face)
          outward.push_back(block.node[e * block.nodes_per_element + static_cast<std::size_t>(corner)]);
        Face& stored = faces[sorted(outward)];
        stored.outward = std::move(outward);
        ++stored.count;
      }
  }
  Faces outside;
  for (auto& [key, face] : faces)
    if (face.count == 1) outside[key] = std::move(face.outward);
  return outside;
}

void add_face(Faces& outside, Corners outward) {
  const auto [face, is_new] = outside.try_emplace(sorted(outward));
  if (is_new)
    face->second = std::move(outward);
  else
    outside.erase(face);
}

Block triangles_of(const Faces& outside) {
  Block surface{type_of(Family::triangle, 1), 3, {}, {}, {}};
  for (const auto& [key, outward] : outside)
    for (std::size_t c = 2; c < outward.size(); ++c) {
      surface.node.insert(surface.node.end(), {outward[0], outward[c - 1], outward[c]});
      surface.tag.push_back(0);
      surface.label.push_back(0);
    }
  return surface;
}

void orient(Block& facets, int order, const Faces& outside, const scene::Body& body, const std::string& key) {
  const ReferenceElement reference = reference_element(facets.gmsh_type);
  if (reference.order != order) throw mixed_orders(body);
  const std::vector<int> to = mirrored(reference);
  for (std::size_t e = 0; e < facets.size(); ++e) {
    const auto nodes = facets.node.begin() + static_cast<std::ptrdiff_t>(e * reference.nodes);
    const auto face = outside.find(sorted({nodes, nodes + reference.corners}));
    if (face == outside.end())
      throw InputError(
          fmt::format("{}: facet {} of {} is not on the body's surface: name a group that bounds the body",
                      body.mesh.filename().string(), facets.tag[e], key));
    const Corners& outward = face->second;
    const auto first =
        static_cast<std::size_t>(std::find(outward.begin(), outward.end(), nodes[0]) - outward.begin());
    if (outward[(first + 1) % outward.size()] == nodes[1]) continue;
    const std::vector<std::int64_t> old(nodes, nodes + reference.nodes);
    for (int n = 0; n < reference.nodes; ++n) nodes[n] = old[static_cast<std::size_t>(to[n])];
  }
}

}  // namespace ricochet::mesh
