// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/faces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

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

/// A face of an element: its type and its nodes, as local numbers in the element, oriented outward.
struct LocalFace {
  int gmsh_type = 0;
  std::vector<std::size_t> node;
};

/// Finds the nodes of a face by their positions in the reference element.
LocalFace face_of(const ReferenceElement& element, const std::vector<int>& corners) {
  const Family family = corners.size() == 3 ? Family::triangle : Family::quadrangle;
  const ReferenceElement facet = reference_element(type_of(family, element.order));
  std::vector<double> local;
  for (std::size_t n = 0; n < static_cast<std::size_t>(facet.nodes); ++n)
    local.insert(local.end(), {facet.node[2 * n], facet.node[2 * n + 1], 0});
  const Basis hats = basis_at(reference_element(type_of(family, 1)), local);
  const auto distance = [&](const std::array<double, 3>& at, std::size_t node) {
    double sum = 0;
    for (std::size_t d = 0; d < 3; ++d) sum += std::abs(at[d] - element.node[3 * node + d]);
    return sum;
  };
  LocalFace face{facet.gmsh_type, {}};
  for (std::size_t n = 0; n < static_cast<std::size_t>(facet.nodes); ++n) {
    std::array<double, 3> at{};
    for (std::size_t k = 0; k < corners.size(); ++k)
      for (std::size_t d = 0; d < 3; ++d)
        at[d] +=
            hats.value[n * corners.size() + k] * element.node[3 * static_cast<std::size_t>(corners[k]) + d];
    std::size_t nearest = 0;
    for (std::size_t node = 1; node < static_cast<std::size_t>(element.nodes); ++node)
      if (distance(at, node) < distance(at, nearest)) nearest = node;
    face.node.push_back(nearest);
  }
  return face;
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

std::vector<Block> boundary_of(const std::vector<Block>& blocks, const Faces& outside) {
  std::vector<Block> boundary;
  for (const Block& block : blocks) {
    const ReferenceElement element = reference_element(block.gmsh_type);
    const auto pattern = outward_faces(element.family);
    for (std::size_t f = 0; f < pattern.size(); ++f) {
      const LocalFace face = face_of(element, pattern[f]);
      auto facets = std::ranges::find(boundary, face.gmsh_type, &Block::gmsh_type);
      if (facets == boundary.end())
        facets = boundary.insert(facets, {face.gmsh_type, static_cast<int>(face.node.size()), {}, {}, {}});
      for (std::size_t e = 0; e < block.size(); ++e) {
        const std::int64_t* nodes = &block.node[e * static_cast<std::size_t>(block.nodes_per_element)];
        Corners corners;
        for (const int corner : pattern[f]) corners.push_back(nodes[corner]);
        if (!outside.contains(sorted(std::move(corners)))) continue;
        for (const std::size_t node : face.node) facets->node.push_back(nodes[node]);
        facets->tag.push_back(6 * block.tag[e] + static_cast<std::int64_t>(f));
        facets->label.push_back(0);
      }
    }
  }
  return boundary;
}

void keep_outside(Block& facets, const Faces& outside) {
  const auto corners = reference_element(facets.gmsh_type).corners;
  const auto width = static_cast<std::ptrdiff_t>(facets.nodes_per_element);
  Block kept{facets.gmsh_type, facets.nodes_per_element, {}, {}, {}};
  for (std::size_t e = 0; e < facets.size(); ++e) {
    const auto nodes = facets.node.begin() + static_cast<std::ptrdiff_t>(e) * width;
    if (!outside.contains(sorted({nodes, nodes + corners}))) continue;
    kept.node.insert(kept.node.end(), nodes, nodes + width);
    kept.tag.push_back(facets.tag[e]);
    kept.label.push_back(facets.label[e]);
  }
  facets = std::move(kept);
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
