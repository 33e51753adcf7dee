// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/send.hpp"

#include <algorithm>

namespace ricochet::mesh {

namespace {

template <class T>
std::vector<T> joined(const std::vector<std::vector<T>>& lists) {
  std::vector<T> all;
  for (const auto& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

/// Sends elements with global node numbers.
/// @return for each rank, the indices of the nodes that it needs
std::vector<Numbers> send_elements(const std::vector<Block>& blocks, const Numbers& rank, const Nodes& nodes,
                                   Mesh& mesh) {
  const auto ranks = static_cast<std::size_t>(parallel::size_of(mesh.comm));
  std::vector<Numbers> used(ranks);
  std::size_t element = 0;
  for (const Block& block : blocks) {
    const auto width = static_cast<std::size_t>(block.nodes_per_element);
    std::vector<Numbers> node(ranks), tag(ranks), label(ranks), own(ranks);
    for (std::size_t e = 0; e < block.size(); ++e, ++element) {
      const std::int64_t* node_of = &block.node[e * width];
      Numbers takers{rank[element]};
      for (std::size_t k = 0; k < width; ++k)
        takers.push_back(nodes.owner[static_cast<std::size_t>(node_of[k])]);
      sort_once(takers);
      for (const std::int64_t taker : takers) {
        const auto r = static_cast<std::size_t>(taker);
        used[r].insert(used[r].end(), node_of, node_of + width);
        for (std::size_t k = 0; k < width; ++k)
          node[r].push_back(nodes.number[static_cast<std::size_t>(node_of[k])]);
        tag[r].push_back(block.tag[e]);
        label[r].push_back(block.label[e]);
        own[r].push_back(taker == rank[element] ? 1 : 0);
      }
    }
    const auto sent = [&](const std::vector<Numbers>& lists) {
      return joined(parallel::exchange(mesh.comm, lists));
    };
    mesh.blocks.push_back({block.gmsh_type, block.nodes_per_element, sent(node), sent(tag), sent(label)});
    mesh.own.push_back(sent(own));
  }
  mesh.total_elements = parallel::sum(mesh.comm, static_cast<std::int64_t>(element));
  return used;
}

/// Sends each rank the nodes that it uses, and converts the nodes of elements to local numbers.
void send_nodes(std::vector<Numbers> used, const std::vector<double>& position, const Nodes& nodes,
                Mesh& mesh) {
  std::vector<Numbers> numbers(used.size());
  std::vector<std::vector<double>> at(used.size());
  for (std::size_t r = 0; r < used.size(); ++r) {
    sort_once(used[r]);
    for (std::int64_t node : used[r]) {
      const auto n = static_cast<std::size_t>(node);
      numbers[r].insert(numbers[r].end(),
                        {nodes.number[n], nodes.canonical[n], nodes.fixed[n], nodes.part[n]});
      at[r].insert(at[r].end(), &position[3 * n], &position[3 * n] + 3);
    }
  }
  numbers = parallel::exchange(mesh.comm, numbers);
  at = parallel::exchange(mesh.comm, at);
  struct Received {
    const std::int64_t* numbers;
    const double* position;
  };
  std::vector<Received> all;
  for (std::size_t r = 0; r < numbers.size(); ++r)
    for (std::size_t k = 0; k < numbers[r].size() / 4; ++k)
      all.push_back({&numbers[r][4 * k], &at[r][3 * k]});
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return *a.numbers < *b.numbers; });
  for (const Received& one : all) {
    if (!mesh.node.empty() && mesh.node.back() == one.numbers[0]) continue;
    mesh.node.push_back(one.numbers[0]);
    mesh.canonical.push_back(one.numbers[1]);
    mesh.fixed.push_back(one.numbers[2]);
    mesh.part.push_back(one.numbers[3]);
    mesh.position.insert(mesh.position.end(), one.position, one.position + 3);
  }
  for (Block& block : mesh.blocks)
    for (std::int64_t& node : block.node)
      node = std::lower_bound(mesh.node.begin(), mesh.node.end(), node) - mesh.node.begin();
}

}  // namespace

std::vector<Block> exchanged(const std::vector<Block>& blocks, const Numbers& rank, MPI_Comm comm) {
  const auto ranks = static_cast<std::size_t>(parallel::size_of(comm));
  std::vector<Block> received;
  auto to = rank.begin();
  for (const Block& block : blocks) {
    const auto width = static_cast<std::size_t>(block.nodes_per_element);
    std::vector<Numbers> node(ranks), tag(ranks), label(ranks);
    for (std::size_t e = 0; e < block.size(); ++e, ++to) {
      const auto r = static_cast<std::size_t>(*to);
      node[r].insert(node[r].end(), &block.node[e * width], &block.node[e * width] + width);
      tag[r].push_back(block.tag[e]);
      label[r].push_back(block.label[e]);
    }
    const auto sent = [&](const std::vector<Numbers>& lists) {
      return joined(parallel::exchange(comm, lists));
    };
    received.push_back({block.gmsh_type, block.nodes_per_element, sent(node), sent(tag), sent(label)});
  }
  return received;
}

void send(const std::vector<Block>& blocks, const Numbers& rank, const std::vector<double>& position,
          const Nodes& nodes, Mesh& mesh) {
  mesh.total_nodes = nodes.total;
  mesh.first_node = nodes.first;
  mesh.owned_nodes = nodes.owned;
  mesh.parts = nodes.parts;
  std::vector<Numbers> used = send_elements(blocks, rank, nodes, mesh);
  // A body given by matrices has no elements, so each rank needs only the nodes that it owns.
  for (std::size_t n = 0; blocks.empty() && n < nodes.owner.size(); ++n)
    used[static_cast<std::size_t>(nodes.owner[n])].push_back(static_cast<std::int64_t>(n));
  send_nodes(std::move(used), position, nodes, mesh);
}

}  // namespace ricochet::mesh
