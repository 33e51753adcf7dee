// SPDX-License-Identifier: BSD-2-Clause
// Names for the nodes of elements of another order than those of a mesh.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <compare>

#include "src/mesh/reference.hpp"

namespace ricochet::mesh {

/// A node by the vertices that it lies between: the same node has the same key in every element and facet.
struct NodeKey {
  /// Ascending numbers of vertices, and the linear shape functions of these at the node, scaled; −1 and 0 for
  /// none.
  std::array<std::int64_t, 8> corner;
  std::array<int, 8> weight;
  auto operator<=>(const NodeKey&) const = default;
};

/// Keys of the nodes of elements of one type.
class NodeKeys {
 public:
  explicit NodeKeys(const ReferenceElement& element);
  /// @param corner  numbers of the corners of the element
  NodeKey of(int node, const std::int64_t* corner) const;
  /// (nodes, corners) scaled linear shape functions
  const Eigen::MatrixXi& weights() const { return weight_; }

 private:
  Eigen::MatrixXi weight_;
};

}  // namespace ricochet::mesh
