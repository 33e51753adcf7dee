// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/elasticity: functions of a higher order on the elements of a mesh.
#pragma once

#include "src/elasticity/element.hpp"
#include "src/mesh/node_key.hpp"

namespace ricochet::elasticity {

/// Elements of order p + q over those of order p of one block.
class Enriched {
 public:
  /// @param points  of the block, which must outlive this; @param raise  q
  Enriched(const ElementPoints& points, int raise);

  int nodes() const { return high_.nodes; }
  /// Shape functions N' of the higher order.
  const Functions& shapes() const { return shapes_; }
  /// w = N' − their interpolation by functions of order p.
  const Functions& surplus() const { return surplus_; }
  /// (nodes, n) the functions of order p at the nodes of the higher order
  const Eigen::MatrixXd& prolongation() const { return prolongation_; }

  const mesh::NodeKeys& keys() const { return keys_; }

  /// Whether all nodes of order p on the vertex, edge or face in whose interior node a lies have a property.
  /// @param property  of node b of order p
  template <class Property>
  bool all_around(int a, const Property& property) const {
    for (const int b : around_[static_cast<std::size_t>(a)])
      if (!property(b)) return false;
    return true;
  }

 private:
  mesh::ReferenceElement high_;
  mesh::NodeKeys keys_;
  Functions shapes_, surplus_;
  Eigen::MatrixXd prolongation_;
  std::vector<std::vector<int>> around_;  ///< nodes of order p
};

}  // namespace ricochet::elasticity
