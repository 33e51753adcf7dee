// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/straighten.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "src/mesh/element_shape.hpp"

namespace ricochet::mesh {

namespace {

/// Calls `visit` with the block, the number and the straight shape of each curved element that is inverted.
template <class Visit>
void each_inverted(const GlobalMesh& mesh, const Visit& visit) {
  constexpr double round_off = 1e-9;
  for (const Block& block : mesh.blocks) {
    const ElementShape curved(block.gmsh_type);
    if (!curved.can_bend()) continue;
    for (std::size_t e = 0; e < block.size(); ++e) {
      const Positions at = positions_of(mesh, block, e), straight = curved.straight(at);
      const double size = (at.colwise().maxCoeff() - at.colwise().minCoeff()).maxCoeff();
      if ((at - straight).cwiseAbs().maxCoeff() > round_off * size && curved.is_inverted(at))
        visit(block, e, straight, curved.corners());
    }
  }
}

}  // namespace

std::int64_t count_inverted(const GlobalMesh& mesh) {
  std::int64_t count = 0;
  each_inverted(mesh, [&](const auto&...) { ++count; });
  return count;
}

Straightened straighten_inverted(GlobalMesh& mesh) {
  Straightened done;
  // Every pass straightens elements that were curved, so the passes end.
  for (std::int64_t before = -1; before != done.elements;) {
    before = done.elements;
    std::vector<std::pair<std::size_t, Eigen::RowVector3d>> moves;
    each_inverted(mesh, [&](const Block& block, std::size_t e, const Positions& straight, int corners) {
      ++done.elements;
      for (int a = corners; a < block.nodes_per_element; ++a)
        moves.emplace_back(
            block.node[e * static_cast<std::size_t>(block.nodes_per_element) + static_cast<std::size_t>(a)],
            straight.row(a));
    });
    for (const auto& [node, to] : moves) {
      Eigen::Map<Eigen::RowVector3d> at(mesh.position.data() + 3 * node);
      done.distance = std::max(done.distance, (at - to).norm());
      at = to;
    }
  }
  return done;
}

}  // namespace ricochet::mesh
