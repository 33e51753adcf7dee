// SPDX-License-Identifier: BSD-2-Clause
#include "src/elasticity/expected_size.hpp"

#include <algorithm>

namespace ricochet::elasticity {
namespace {

/// Memory of blocks of K and M of a solid or of a rod [MiB].
double mib_of(double blocks, int dim) {
  const double size = dim == 3 ? 3 : 1, entries = size * size;
  // K and M, the copy of K for products, and that of M, whose blocks are diagonal but stored in full rows.
  const double matrices = 3 * (8 * entries + 4) + 2 * (8 * size + 4);
  // Row, column, K, M and K − σM of each entry.
  const double input = (2 * 4 + 3 * 8) * entries;
  return blocks * (matrices + input) / (1 << 20);
}

}  // namespace

double expected_blocks(const mesh::Mesh& mesh, std::int64_t sample) {
  const std::int64_t nodes = mesh.owned_nodes, stride = (nodes + sample - 1) / sample;
  if (nodes == 0 || mesh.total_elements == 0) return 0;
  std::vector<std::vector<std::int64_t>> neighbours(static_cast<std::size_t>((nodes + stride - 1) / stride));
  for (const mesh::Block& block : mesh.blocks) {
    const auto each = static_cast<std::size_t>(block.nodes_per_element);
    for (std::size_t first = 0; first < block.node.size(); first += each) {
      const auto begin = block.node.begin() + static_cast<std::ptrdiff_t>(first);
      for (std::size_t k = 0; k < each; ++k)
        if (const std::int64_t node =
                mesh.owned(mesh.node[static_cast<std::size_t>(begin[static_cast<std::ptrdiff_t>(k)])]);
            node >= 0 && node % stride == 0) {
          auto& list = neighbours[static_cast<std::size_t>(node / stride)];
          list.insert(list.end(), begin, begin + static_cast<std::ptrdiff_t>(each));
        }
    }
  }
  double total = 0;
  for (auto& list : neighbours) {
    std::ranges::sort(list);
    total += static_cast<double>(std::unique(list.begin(), list.end()) - list.begin());
  }
  const auto all = static_cast<double>(nodes);
  return (total * (all / static_cast<double>(neighbours.size())) + all) / 2;
}

double expected_mib(const mesh::Mesh& mesh) { return mib_of(expected_blocks(mesh), mesh.dim); }

double least_mib(std::int64_t nodes) {
  // Each node shares an element with three others at least. Pairs count once.
  return mib_of(2.5 * static_cast<double>(nodes), 3);
}

}  // namespace ricochet::elasticity
