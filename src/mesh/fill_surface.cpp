// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/fill_surface.hpp"

#include <fmt/format.h>
#include <gmsh.h>

#include <array>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "ricochet/error.hpp"

namespace ricochet::mesh {

namespace {

using Edge = std::pair<std::size_t, std::size_t>;  ///< tags of its ends, the lower one first

/// How many triangles of the model meet at each edge.
std::map<Edge, int> triangles_at_edges() {
  std::vector<std::size_t> tags, nodes;
  gmsh::model::mesh::getElementsByType(gmsh::model::mesh::getElementType("triangle", 1), tags, nodes);
  std::map<Edge, int> count;
  for (std::size_t t = 0; t + 2 < nodes.size(); t += 3)
    for (const auto& [a, b] : {Edge{t, t + 1}, Edge{t + 1, t + 2}, Edge{t + 2, t}})
      ++count[std::minmax(nodes[a], nodes[b])];
  return count;
}

void refuse_open(const std::string& file) {
  const std::map<Edge, int> count = triangles_at_edges();
  if (count.empty())
    throw InputError(fmt::format("{}: holds no triangles: export the surface of the body again", file));
  std::size_t wrong = 0;
  std::vector<double> at, ignored;
  for (const auto& [edge, triangles] : count)
    if (triangles != 2 && wrong++ == 0) gmsh::model::mesh::getNode(edge.first, at, ignored);
  if (wrong > 0)
    throw InputError(fmt::format(
        "{}: is not a closed surface: {} of its {} edges do not belong to two triangles, the first at "
        "({:.6g}, "
        "{:.6g}, {:.6g}) in its units: close the holes, for example in MeshLab, and remove inner walls",
        file, wrong, count.size(), at[0], at[1], at[2]));
}

}  // namespace

void fill_surface(const std::string& file) {
  refuse_open(file);
  gmsh::vectorpair surfaces;
  gmsh::model::getEntities(surfaces, 2);
  std::vector<int> tags;
  for (const auto& [dim, tag] : surfaces) tags.push_back(tag);
  gmsh::model::geo::addVolume({gmsh::model::geo::addSurfaceLoop(tags)});
  gmsh::model::geo::synchronize();
}

}  // namespace ricochet::mesh
