// SPDX-License-Identifier: BSD-2-Clause
// The same elements with shape functions of the next lower order.
#pragma once

#include <Eigen/Dense>

#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// A mesh of the next lower order on the same ranks, and the prolongation from it to the original order.
class OrderReduction {
 public:
  /// Every node of the lower order takes the number, the owner and the supports of a node of `mesh` that lies
  /// inside the same corner, edge, face or element; there are at least as many of these. Its position is
  /// computed on the elements of `mesh`. Facets are omitted. Needs a GmshSession. Collective.
  /// @param mesh  of order 2 or more
  explicit OrderReduction(const Mesh& mesh);

  const Mesh& mesh() const { return mesh_; }

  /// Prolongation: the displacements of the lower order at the nodes of the higher one; 0 at displacements
  /// that supports hold.
  /// @param columns  (local rows of the lower order, n)
  /// @return (local rows, n). Collective.
  Eigen::MatrixXd prolong(const Eigen::Ref<const Eigen::MatrixXd>& columns) const;

 private:
  void number(const Mesh& mesh, const std::vector<std::int64_t>& taken);
  void prepare_exchange();

  Mesh mesh_;
  /// For each node of the higher order that this rank owns: local nodes of the lower order and their weights.
  std::vector<std::vector<std::pair<std::int64_t, double>>> weights_;
  std::vector<std::int64_t> held_;  ///< rows of the higher order
  /// Nodes of the lower order that other ranks own: by owner, their local numbers here; by requesting rank,
  /// their local numbers on this owner.
  std::vector<std::vector<std::int64_t>> ghost_, asked_;
};

}  // namespace ricochet::mesh
