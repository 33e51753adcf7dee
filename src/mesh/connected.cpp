// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/connected.hpp"

#include <algorithm>
#include <numeric>

namespace ricochet::mesh {

std::vector<std::int64_t> first_connected(std::size_t nodes, const std::vector<Block>& blocks) {
  // Union-find with path halving.
  std::vector<std::int64_t> root(nodes);
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](std::int64_t node) {
    for (auto at = static_cast<std::size_t>(node); root[at] != static_cast<std::int64_t>(at);
         at = static_cast<std::size_t>(root[at]))
      root[at] = node = root[static_cast<std::size_t>(root[at])];
    return node;
  };
  for (const Block& block : blocks) {
    const auto width = static_cast<std::size_t>(block.nodes_per_element);
    for (std::size_t k = 0; k < block.node.size(); ++k) {
      const std::int64_t a = find(block.node[k - k % width]), b = find(block.node[k]);
      root[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  }
  std::vector<std::int64_t> first(nodes);
  for (std::size_t i = 0; i < nodes; ++i) first[i] = find(static_cast<std::int64_t>(i));
  return first;
}

}  // namespace ricochet::mesh
