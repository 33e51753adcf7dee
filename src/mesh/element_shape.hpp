// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/mesh: straight and inverted elements, by the positions of their nodes.
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <vector>

#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

using Weights = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Positions = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/// The shape of the elements of one type, by the positions of their nodes. Needs a GmshSession.
class ElementShape {
 public:
  explicit ElementShape(int gmsh_type) : element_(reference_element(gmsh_type)) {
    const ReferenceElement straight = reference_element(type_of(element_.family, 1));
    std::vector<double> local;
    for (int a = 0; a < element_.nodes; ++a)
      for (int d = 0; d < 3; ++d)
        local.push_back(d < element_.dim ? element_.node[static_cast<std::size_t>(a * element_.dim + d)] : 0);
    weights_ =
        Eigen::Map<const Weights>(basis_at(straight, local).value.data(), element_.nodes, straight.nodes);
    basis_ = basis_at(element_, quadrature_of(element_.family, 2 * element_.order + 2).local);
  }

  const ReferenceElement& reference() const { return element_; }
  int corners() const { return element_.corners; }
  bool can_bend() const { return element_.dim == 3 && element_.order > 1; }

  /// The nodes where straight edges place them.
  Positions straight(const Positions& at) const { return weights_ * at.topRows(element_.corners); }

  /// Whether the Jacobian is not positive at every quadrature point of assembly.
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

/// (nodes,3) [m]
inline Positions positions_of(const GlobalMesh& mesh, const Block& block, std::size_t element) {
  Positions at(block.nodes_per_element, 3);
  for (int a = 0; a < block.nodes_per_element; ++a) {
    const auto node = static_cast<std::size_t>(
        block
            .node[element * static_cast<std::size_t>(block.nodes_per_element) + static_cast<std::size_t>(a)]);
    for (int k = 0; k < 3; ++k) at(a, k) = mesh.position[3 * node + static_cast<std::size_t>(k)];
  }
  return at;
}

}  // namespace ricochet::mesh
