// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/node_key.hpp"

#include <cmath>

namespace ricochet::mesh {

NodeKeys::NodeKeys(const ReferenceElement& element) {
  const Basis linear = basis_at(reference_element(type_of(element.family, 1)), local_nodes(element));
  // Products of up to three coordinates, each a multiple of 1/order.
  weight_ = (Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
                 linear.value.data(), linear.points, linear.nodes) *
             std::pow(element.order, 3))
                .array()
                .round()
                .cast<int>();
}

NodeKey NodeKeys::of(int node, const std::int64_t* corner) const {
  NodeKey key;
  key.corner.fill(-1);
  key.weight.fill(0);
  std::size_t count = 0;
  for (Eigen::Index c = 0; c < weight_.cols(); ++c) {
    if (weight_(node, c) == 0) continue;
    std::size_t at = count++;
    for (; at > 0 && key.corner[at - 1] > corner[c]; --at) {
      key.corner[at] = key.corner[at - 1];
      key.weight[at] = key.weight[at - 1];
    }
    key.corner[at] = corner[c];
    key.weight[at] = weight_(node, c);
  }
  return key;
}

}  // namespace ricochet::mesh
