// SPDX-License-Identifier: BSD-2-Clause
// The same elements with functions of the next lower order.
#pragma once

#include <Eigen/Dense>

#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// A mesh of the next lower order on the same ranks, and the way up from it.
class Lower {
 public:
  /// Every node of the lower order takes the number, the owner and the supports of one of `mesh` that lies in
  /// the inside of the same corner, edge, face or element, of which there are at least as many. Its place is
  /// that on the elements of `mesh`; facets are left out. Needs a GmshSession. Collective.
  /// @param mesh  of order 2 or more
  explicit Lower(const Mesh& mesh);

  const Mesh& mesh() const { return mesh_; }

  /// Displacements of the lower order at the nodes of the higher one; 0 where supports hold those.
  /// @param columns (lower's local rows, n), @return (local rows, n). Collective.
  Eigen::MatrixXd raise(const Eigen::Ref<const Eigen::MatrixXd>& columns) const;

 private:
  void number(const Mesh& mesh, const std::vector<std::int64_t>& taken);
  void prepare_exchange();

  Mesh mesh_;
  /// Per node that this rank owns of the higher order: local nodes of the lower one and their weights.
  std::vector<std::size_t> start_;
  std::vector<std::int64_t> node_;
  std::vector<double> weight_;
  std::vector<std::int64_t> held_;  ///< rows of the higher order
  /// Nodes of the lower order that others own: by owner, their local numbers here; by rank that asks, their
  /// local numbers where they are owned.
  std::vector<std::vector<std::int64_t>> ghost_, asked_;
};

}  // namespace ricochet::mesh
