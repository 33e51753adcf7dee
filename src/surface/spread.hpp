// SPDX-License-Identifier: BSD-2-Clause
// Unit forces distributed over the nodes of a mesh by weights.
#pragma once

#include <Eigen/SparseCore>
#include <optional>
#include <vector>

#include "src/mesh/mesh.hpp"

namespace ricochet::surface {

/// One weight of a patch. Candidate i spreads a unit force over the nodes, C(node, i) = (1/A_i) ∫ w_i N_node
/// ds. Loads and receivers use the same structure, with their own index as `candidate`.
struct Weight {
  std::int64_t node;  ///< global
  int candidate;
  double value;
  Vector3 by_component{1, 1, 1};  ///< factors of the components at the place
};

enum class FixedRows { zero, filled };

/// Returns unit forces at `places`, distributed by weights. Column 3·i + k is component k at place i; with a
/// `direction`, column i is the component along it. If fixed rows are filled, the transpose gives the
/// displacement of the places from the displacement of all nodes.
/// @return (local rows, columns) [N]
Eigen::SparseMatrix<double> spread(const mesh::Mesh& mesh, const std::vector<Weight>& weights,
                                   std::size_t places, const std::optional<Vector3>& direction,
                                   FixedRows fixed);

}  // namespace ricochet::surface
