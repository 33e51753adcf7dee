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

/// Triangles between neighbouring nodes of a facet, as local numbers in it, facing as the facet does.
std::vector<std::size_t> lattice_of(const ReferenceElement& facet) {
  const int order = facet.order;
  const bool is_triangle = facet.family == Family::triangle;
  const auto place = [&](double local) { return is_triangle ? local : (local + 1) / 2; };
  std::vector<std::size_t> number(static_cast<std::size_t>((order + 1) * (order + 1)));
  for (int n = 0; n < facet.nodes; ++n) {
    const auto i = std::lround(order * place(facet.node[2 * n])),
               j = std::lround(order * place(facet.node[2 * n + 1]));
    number[static_cast<std::size_t>(j * (order + 1) + i)] = static_cast<std::size_t>(n);
  }
  std::vector<std::size_t> triangles;
  const auto add = [&](std::initializer_list<std::array<int, 2>> corners) {
    for (const auto& [i, j] : corners)
      triangles.push_back(number[static_cast<std::size_t>(j * (order + 1) + i)]);
  };
  for (int j = 0; j < order; ++j)
    for (int i = 0; i < (is_triangle ? order - j : order); ++i) {
      if (!is_triangle) {
        add({{i, j}, {i + 1, j}, {i + 1, j + 1}});
        add({{i, j}, {i + 1, j + 1}, {i, j + 1}});
        continue;
      }
      add({{i, j}, {i + 1, j}, {i, j + 1}});
      if (i + j + 1 < order) add({{i + 1, j}, {i + 1, j + 1}, {i, j + 1}});
    }
  return triangles;
}

/// The triangles of a visualisation surface: between all nodes of its faces, and between their corners alone.
class Triangles {
 public:
  /// Adds a face. @param nodes  in the order of gmsh, oriented outward; its first are the corners
  void add(Family family, int order, const std::int64_t* nodes) {
    divided_ = divided_ || order > 1;
    append(family, order, nodes, fine_);
    append(family, 1, nodes, coarse_);
  }

  std::vector<Block> blocks() && {
    std::vector<Block> blocks;
    for (std::vector<std::int64_t>* node : {&fine_, &coarse_}) {
      const std::vector<std::int64_t> none(node->size() / 3, 0);
      if (blocks.empty() || divided_)
        blocks.push_back({type_of(Family::triangle, 1), 3, std::move(*node), none, none});
    }
    return blocks;
  }

 private:
  void append(Family family, int order, const std::int64_t* nodes, std::vector<std::int64_t>& to) {
    std::vector<std::size_t>& lattice = lattices_[{family, order}];
    if (lattice.empty()) lattice = lattice_of(reference_element(type_of(family, order)));
    for (const std::size_t node : lattice) to.push_back(nodes[node]);
  }

  bool divided_ = false;
  std::vector<std::int64_t> fine_, coarse_;
  std::map<std::pair<Family, int>, std::vector<std::size_t>> lattices_;
};

}  // namespace

Faces outside_of(const std::vector<Block>& blocks) {
  struct Found {
    std::int64_t count = 0;
    std::size_t block = 0, element = 0, face = 0;
  };
  std::map<Corners, Found> faces;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const Block& block = blocks[b];
    const auto pattern = outward_faces(reference_element(block.gmsh_type).family);
    for (std::size_t e = 0; e < block.size(); ++e)
      for (std::size_t f = 0; f < pattern.size(); ++f) {
        Corners corners;
        for (const int corner : pattern[f])
          corners.push_back(block.node[e * block.nodes_per_element + static_cast<std::size_t>(corner)]);
        Found& found = faces[sorted(std::move(corners))];
        found = {found.count + 1, b, e, f};
      }
  }
  std::vector<std::vector<LocalFace>> local;
  for (const Block& block : blocks) {
    const ReferenceElement element = reference_element(block.gmsh_type);
    std::vector<LocalFace>& of_block = local.emplace_back();
    for (const std::vector<int>& corners : outward_faces(element.family))
      of_block.push_back(face_of(element, corners));
  }
  Faces outside;
  for (const auto& [corners, face] : faces) {
    if (face.count != 1) continue;
    const Block& block = blocks[face.block];
    FaceNodes& nodes = outside[corners];
    for (const std::size_t node : local[face.block][face.face].node)
      nodes.push_back(block.node[face.element * block.nodes_per_element + node]);
  }
  return outside;
}

void add_face(Faces& outside, Corners corners, FaceNodes nodes) {
  const auto [face, is_new] = outside.try_emplace(sorted(std::move(corners)));
  if (is_new)
    face->second = std::move(nodes);
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

std::vector<Block> triangles_of(const Faces& outside, int order) {
  Triangles surface;
  for (const auto& [corners, nodes] : outside)
    surface.add(corners.size() == 3 ? Family::triangle : Family::quadrangle, order, nodes.data());
  return std::move(surface).blocks();
}

std::vector<Block> triangles_of(const std::vector<Block>& facets) {
  Triangles surface;
  for (const Block& block : facets) {
    const ReferenceElement facet = reference_element(block.gmsh_type);
    for (std::size_t e = 0; e < block.size(); ++e)
      surface.add(facet.family, facet.order, &block.node[e * block.nodes_per_element]);
  }
  return std::move(surface).blocks();
}

void keep_corners(FacetMesh& surface) {
  surface.blocks = {std::move(surface.blocks.back())};
  std::vector<std::int64_t>& element = surface.blocks.front().node;
  std::vector<std::int64_t> kept = element;
  sort_once(kept);
  for (std::int64_t& node : element) node = std::ranges::lower_bound(kept, node) - kept.begin();
  FacetMesh whole = std::exchange(surface, {{}, {}, std::move(surface.blocks), {}});
  for (const std::int64_t node : kept) {
    const auto n = static_cast<std::size_t>(node);
    surface.node.push_back(whole.node[n]);
    surface.position.insert(surface.position.end(), &whole.position[3 * n], &whole.position[3 * n] + 3);
  }
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
    const auto outward = face->second.begin();
    const auto first = std::find(outward, outward + reference.corners, nodes[0]) - outward;
    if (outward[(first + 1) % reference.corners] == nodes[1]) continue;
    const std::vector<std::int64_t> old(nodes, nodes + reference.nodes);
    for (int n = 0; n < reference.nodes; ++n) nodes[n] = old[static_cast<std::size_t>(to[n])];
  }
}

}  // namespace ricochet::mesh
