// SPDX-License-Identifier: BSD-2-Clause
// Fields at all nodes of the elements of a rank, also at those that other ranks own.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

class Halo {
 public:
  /// The mesh must outlive this. Collective on its ranks.
  explicit Halo(const Mesh& mesh);

  /// Returns a field at the local nodes, in their order. Collective.
  /// @param owned  (c · owned nodes, n), node by node
  /// @return (c · local nodes, n)
  Eigen::MatrixXd operator()(const Eigen::Ref<const Eigen::MatrixXd>& owned) const;

 private:
  const Mesh& mesh_;
  std::vector<std::vector<std::int64_t>> given_;  ///< by rank: owned nodes that it needs
  std::vector<std::vector<std::size_t>> taken_;   ///< by rank: local nodes that it owns
};

}  // namespace ricochet::mesh
