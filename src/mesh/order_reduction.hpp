// SPDX-License-Identifier: BSD-2-Clause
// A mesh with the same elements and shape functions of the next lower order.
#pragma once

#include <Eigen/Dense>

#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// A mesh of the next lower order on the same ranks, and the prolongation from it to the original order.
class OrderReduction {
 public:
  /// Each node of the lower order is matched with a node of `mesh` at the same corner or inside the same
  /// edge, face or element, and takes its owner and supports; `mesh` has enough nodes there. Positions are
  /// interpolated on the elements of `mesh`. Facets are omitted. Needs a GmshSession. Collective.
  /// @param mesh  of order 2 or more
  explicit OrderReduction(const Mesh& mesh);

  const Mesh& mesh() const { return mesh_; }

  /// Interpolates displacements of the lower order at the nodes of the higher order. Held displacements are
  /// set to 0.
  /// @param columns  (local rows of the lower order, n)
  /// @return (local rows, n). Collective.
  Eigen::MatrixXd prolong(const Eigen::Ref<const Eigen::MatrixXd>& columns) const;

 private:
  void number(const Mesh& mesh, const std::vector<std::int64_t>& taken);
  void prepare_exchange();

  Mesh mesh_;
  /// For each node of the higher order that this rank owns: local nodes of the lower order and their weights.
  std::vector<std::vector<std::pair<std::int64_t, double>>> weights_;
  std::vector<std::int64_t> held_;  ///< held rows of the higher order
  /// Nodes of the lower order that ranks exchange. `ghost_`: by owner, local numbers of nodes that other
  /// ranks own; `asked_`: by requesting rank, indices among the nodes that this rank owns.
  std::vector<std::vector<std::int64_t>> ghost_, asked_;
};

}  // namespace ricochet::mesh
