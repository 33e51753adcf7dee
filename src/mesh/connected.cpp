// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/connected.hpp"

#include <algorithm>
#include <numeric>

namespace ricochet::mesh {

Connections::Connections(std::size_t nodes) : root_(nodes) { std::iota(root_.begin(), root_.end(), 0); }

void Connections::join(std::int64_t a, std::int64_t b) {
  const std::int64_t root_a = first(a), root_b = first(b);
  root_[static_cast<std::size_t>(std::max(root_a, root_b))] = std::min(root_a, root_b);
}

std::int64_t Connections::first(std::int64_t node) {
  for (auto at = static_cast<std::size_t>(node); root_[at] != static_cast<std::int64_t>(at);
       at = static_cast<std::size_t>(root_[at]))
    root_[at] = node = root_[static_cast<std::size_t>(root_[at])];
  return node;
}

std::vector<std::int64_t> first_connected(std::size_t nodes, const std::vector<Block>& blocks) {
  Connections connections(nodes);
  for (const Block& block : blocks) {
    const auto width = static_cast<std::size_t>(block.nodes_per_element);
    for (std::size_t k = 0; k < block.node.size(); ++k)
      connections.join(block.node[k - k % width], block.node[k]);
  }
  std::vector<std::int64_t> first(nodes);
  for (std::size_t i = 0; i < nodes; ++i) first[i] = connections.first(static_cast<std::int64_t>(i));
  return first;
}

std::vector<std::int64_t> lowest_connected(MPI_Comm comm, const Directory& directory,
                                           const std::vector<std::int64_t>& tags,
                                           const std::vector<std::int64_t>& first) {
  std::vector<std::int64_t> lowest = tags;
  for (std::int64_t changed = 1; changed != 0;) {
    std::vector<std::int64_t> of_group =
        directory.combined(lowest, [](auto a, auto b) { return std::min(a, b); });
    for (std::size_t n = 0; n < first.size(); ++n) {
      std::int64_t& group = of_group[static_cast<std::size_t>(first[n])];
      group = std::min(group, of_group[n]);
    }
    std::int64_t lower = 0;
    for (std::size_t n = 0; n < first.size(); ++n) {
      const std::int64_t tag = of_group[static_cast<std::size_t>(first[n])];
      lower += tag < lowest[n] ? 1 : 0;
      lowest[n] = tag;
    }
    changed = parallel::sum(comm, lower);
  }
  return lowest;
}

}  // namespace ricochet::mesh
