// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/triangulate.hpp"

#include <fmt/format.h>
#include <gmsh.h>

#include <cstdlib>
#include <string>
#include <unordered_map>
#include <utility>

#include "src/mesh/faces.hpp"
#include "src/mesh/gmsh_session.hpp"
#include "src/mesh/open.hpp"
#include "src/mesh/read.hpp"

namespace ricochet::mesh {

namespace {

bool has_volume_elements() {
  std::vector<int> types;
  gmsh::model::mesh::getElementTypes(types, 3);
  return !types.empty();
}

/// Surfaces that bound the volumes of the model from outside; all surfaces if there is no volume.
gmsh::vectorpair outer_surfaces() {
  gmsh::vectorpair volumes, surfaces;
  gmsh::model::getEntities(volumes, 3);
  if (volumes.empty())
    gmsh::model::getEntities(surfaces, 2);
  else
    gmsh::model::getBoundary(volumes, surfaces, /*combined=*/true, /*oriented=*/false);
  return surfaces;
}

/// Triangles of the faces of gmsh's model.
class Triangulator {
 public:
  Triangulator() {
    std::vector<std::size_t> tags;
    std::vector<double> parametric;
    gmsh::model::mesh::getNodes(tags, out_.position, parametric);
    for (std::size_t i = 0; i < tags.size(); ++i) index_[tags[i]] = static_cast<std::int64_t>(i);
  }

  void add(int surface) {
    std::vector<int> types;
    std::vector<std::vector<std::size_t>> tags, nodes;
    gmsh::model::mesh::getElements(types, tags, nodes, 2, surface);
    std::vector<Block> facets;
    for (std::size_t t = 0; t < types.size(); ++t) {
      Block& block = facets.emplace_back(Block{types[t], reference_element(types[t]).nodes, {}, {}, {}});
      for (const std::size_t tag : tags[t]) block.tag.push_back(static_cast<std::int64_t>(tag));
      for (const std::size_t node : nodes[t]) block.node.push_back(index_.at(node));
    }
    if (facets.empty()) return;
    const std::vector<Block> triangles = triangles_of(facets);
    const std::vector<std::int64_t>& corners = triangles.front().node;
    out_.triangle.insert(out_.triangle.end(), corners.begin(), corners.end());
    std::string type;
    gmsh::model::getType(2, surface, type);
    if (type != "Discrete surface") add_exact(surface, corners);
  }

  Triangulation take() { return std::move(out_); }

 private:
  void add_exact(int surface, const std::vector<std::int64_t>& corners) {
    std::vector<double> middle(corners.size(), 0), closest, parametric;
    for (std::size_t t = 0; t < corners.size(); t += 3)
      for (std::size_t k = 0; k < 9; ++k)
        middle[t + k % 3] += out_.position[3 * static_cast<std::size_t>(corners[t + k / 3]) + k % 3] / 3;
    gmsh::model::getClosestPoint(2, surface, middle, closest, parametric);
    out_.exact.insert(out_.exact.end(), closest.begin(), closest.end());
  }

  Triangulation out_;
  std::unordered_map<std::size_t, std::int64_t> index_;
};

/// The outer faces of a mesh of volumes.
Triangulation outside_of_mesh(scene::Body body) {
  body.materials = {{}};  // of all volumes
  GlobalMesh mesh = read_mesh(body);
  if (mesh.visualisation.blocks.empty()) return {};
  return {std::move(mesh.position), std::move(mesh.visualisation.blocks.front().node), {}, {}};
}

}  // namespace

Triangulation triangulate(const scene::Body& body) {
  const std::string file = body.mesh.filename().string();
  Triangulation out;
  bool solid = false;
  with_gmsh_errors(file, [&] {
    const Opened opened = open_surface(body);
    solid = opened.meshed_before && has_volume_elements();
    if (solid) return;
    Triangulator triangulator;
    for (const auto& [dim, surface] : outer_surfaces()) triangulator.add(std::abs(surface));
    out = triangulator.take();
    out.sewn = opened.sewn;
  });
  if (solid) out = outside_of_mesh(body);
  if (out.triangle.empty())
    throw InputError(fmt::format("{}: holds no faces: export the obstacle as a solid, in .step", file));
  return out;
}

}  // namespace ricochet::mesh
