// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/rod.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

namespace ricochet::mesh {

namespace {

std::array<std::int64_t, 2> ends_of(const Block& lines, std::size_t element) {
  const std::int64_t* node = &lines.node[element * static_cast<std::size_t>(lines.nodes_per_element)];
  return {node[0], node[1]};
}

}  // namespace

void find_axis(GlobalMesh& mesh, const std::string& file) {
  // The ends of the rod are the two nodes that belong to only one line each. All other nodes must lie on the
  // line between them.
  const auto at = [&](std::int64_t n, int c) { return mesh.position[3 * static_cast<std::size_t>(n) + c]; };
  std::map<std::int64_t, int> uses;
  std::vector<std::int64_t> all;
  for (const Block& block : mesh.blocks) {
    all.insert(all.end(), block.node.begin(), block.node.end());
    for (std::size_t e = 0; e < block.size(); ++e)
      for (std::int64_t end : ends_of(block, e)) ++uses[end];
  }
  std::vector<std::int64_t> ends;
  for (const auto& [node, count] : uses)
    if (count == 1) ends.push_back(node);
  if (ends.size() != 2)
    throw InputError(
        fmt::format("{}: a rod must be one chain of lines, but this one has {} ends", file, ends.size()));
  double length = 0;
  for (int c = 0; c < 3; ++c) {
    mesh.axis[c] = at(ends[1], c) - at(ends[0], c);
    length += mesh.axis[c] * mesh.axis[c];
  }
  length = std::sqrt(length);
  for (double& x : mesh.axis) x /= length;
  for (std::int64_t node : all) {
    double along = 0, square = 0;
    for (int c = 0; c < 3; ++c) {
      const double d = at(node, c) - at(ends[0], c);
      along += d * mesh.axis[c];
      square += d * d;
    }
    if (square - along * along > 1e-12 * length * length)
      throw InputError(fmt::format("{}: a rod must be straight; mesh a bent one with volume elements", file));
  }
}

void orient_ends(const GlobalMesh& mesh, FacetMesh& facets, const scene::Body& body, const std::string& key) {
  facets.end_normal.assign(mesh.position.size(), 0);
  std::vector<std::int64_t> ends;
  for (const Block& points : facets.blocks) ends.insert(ends.end(), points.node.begin(), points.node.end());
  for (std::int64_t end : ends) {
    int touching = 0;
    for (const Block& lines : mesh.blocks)
      for (std::size_t e = 0; e < lines.size(); ++e) {
        const auto corners = ends_of(lines, e);
        if (corners[0] != end && corners[1] != end) continue;
        ++touching;
        const double area = body.materials[static_cast<std::size_t>(lines.label[e])].area;
        const std::int64_t other = corners[0] == end ? corners[1] : corners[0];
        double side = 0;
        for (int c = 0; c < 3; ++c)
          side += (mesh.position[3 * end + c] - mesh.position[3 * other + c]) * mesh.axis[c];
        for (int c = 0; c < 3; ++c) facets.end_normal[3 * end + c] = (side > 0 ? area : -area) * mesh.axis[c];
      }
    if (touching != 1)
      throw InputError(fmt::format("{}: {} has a point that is not an end of the rod: name its ends",
                                   body.mesh.filename().string(), key));
  }
}

Block lines_of(const std::vector<Block>& blocks) {
  Block surface{type_of(Family::line, 1), 2, {}, {}, {}};
  for (const Block& block : blocks)
    for (std::size_t e = 0; e < block.size(); ++e) {
      const auto ends = ends_of(block, e);
      surface.node.insert(surface.node.end(), ends.begin(), ends.end());
      surface.tag.push_back(0);
      surface.label.push_back(0);
    }
  return surface;
}

}  // namespace ricochet::mesh
