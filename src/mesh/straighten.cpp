// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/straighten.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <utility>
#include <vector>

namespace ricochet::mesh {

namespace {

using Weights = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Positions = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/// The shape of the elements of one type.
class Curved {
 public:
  explicit Curved(int gmsh_type) : element_(reference_element(gmsh_type)) {
    const ReferenceElement straight = reference_element(type_of(element_.family, 1));
    std::vector<double> local;
    for (int a = 0; a < element_.nodes; ++a)
      for (int d = 0; d < 3; ++d)
        local.push_back(d < element_.dim ? element_.node[static_cast<std::size_t>(a * element_.dim + d)] : 0);
    weights_ =
        Eigen::Map<const Weights>(basis_at(straight, local).value.data(), element_.nodes, straight.nodes);
    basis_ = basis_at(element_, quadrature_of(element_.family, 2 * element_.order + 2).local);
  }

  int corners() const { return element_.corners; }
  bool can_bend() const { return element_.dim == 3 && element_.order > 1; }

  /// The nodes where straight edges place them.
  Positions straight(const Positions& at) const { return weights_ * at.topRows(element_.corners); }

  bool is_inverted(const Positions& at) const {
    for (int q = 0; q < basis_.points; ++q) {
      const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>> gradient(
          basis_.gradient.data() + static_cast<std::ptrdiff_t>(q) * element_.nodes * 3, element_.nodes, 3);
      if (!((gradient.transpose() * at).determinant() > 0)) return true;
    }
    return false;
  }

 private:
  ReferenceElement element_;
  Weights weights_;  ///< (nodes, corners)
  Basis basis_;
};

Positions positions_of(const GlobalMesh& mesh, const Block& block, std::size_t element) {
  Positions at(block.nodes_per_element, 3);
  for (int a = 0; a < block.nodes_per_element; ++a) {
    const auto node = static_cast<std::size_t>(
        block
            .node[element * static_cast<std::size_t>(block.nodes_per_element) + static_cast<std::size_t>(a)]);
    for (int k = 0; k < 3; ++k) at(a, k) = mesh.position[3 * node + static_cast<std::size_t>(k)];
  }
  return at;
}

/// Calls `visit` with the block, the number and the straight shape of each curved element that is inverted.
template <class Visit>
void each_inverted(const GlobalMesh& mesh, const Visit& visit) {
  constexpr double round_off = 1e-9;
  for (const Block& block : mesh.blocks) {
    const Curved curved(block.gmsh_type);
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
