// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/number.hpp"

#include <algorithm>

#include "src/mesh/connected.hpp"
#include "src/mesh/directory.hpp"

namespace ricochet::mesh {

namespace {

/// Returns the distinct values of all ranks, in ascending order, on every rank. Collective.
Numbers united(MPI_Comm comm, const Numbers& mine) {
  Numbers all = parallel::gather(comm, mine);
  sort_once(all);
  parallel::broadcast(comm, all);
  return all;
}

/// Finds the connected parts of the body.
void find_connected_parts(MPI_Comm comm, const Part& part, const Directory& directory, Nodes& nodes) {
  Numbers& lowest = nodes.part =
      lowest_connected(comm, directory, part.tag, first_connected(part.tag.size(), part.blocks));
  Numbers firsts;
  for (std::size_t n = 0; n < lowest.size(); ++n)
    if (lowest[n] == part.tag[n]) firsts.push_back(lowest[n]);
  firsts = united(comm, firsts);
  nodes.parts = static_cast<std::int64_t>(firsts.size());
  for (std::int64_t& of_node : lowest)
    of_node = std::lower_bound(firsts.begin(), firsts.end(), of_node) - firsts.begin();
}

}  // namespace

void collect_tags(Part& part) {
  for (const Block& block : part.blocks)
    part.tag.insert(part.tag.end(), block.node.begin(), block.node.end());
  sort_once(part.tag);
  for (Block& block : part.blocks)
    for (std::int64_t& node : block.node) node = std::ranges::lower_bound(part.tag, node) - part.tag.begin();
}

Nodes number_nodes(const Part& part, MPI_Comm comm) {
  const std::int64_t me = parallel::rank_of(comm);
  const Directory directory(comm, part.tag);
  Nodes nodes;
  nodes.owner =
      directory.combined(Numbers(part.tag.size(), me), [](auto a, auto b) { return std::min(a, b); });
  // If a part touches a support only at a corner, its file contains no facet of the support.
  nodes.fixed = directory.combined(part.fixed, [](auto a, auto b) { return a | b; });
  nodes.owned = std::count(nodes.owner.begin(), nodes.owner.end(), me);
  nodes.total = parallel::sum(comm, nodes.owned);
  nodes.first = parallel::sum_before(comm, nodes.owned);
  std::int64_t next = nodes.first;
  Numbers number(part.tag.size(), -1);
  for (std::size_t n = 0; n < number.size(); ++n)
    if (nodes.owner[n] == me) number[n] = next++;
  nodes.number = directory.combined(number, [](auto a, auto b) { return std::max(a, b); });
  nodes.canonical = directory.order();
  find_connected_parts(comm, part, directory, nodes);
  return nodes;
}

Mesh numbered(const Part& part, const Nodes& nodes, MPI_Comm comm) {
  Mesh mesh;
  mesh.comm = comm;
  mesh.order = part.order;
  std::size_t elements = 0;
  for (const Block& block : part.blocks) elements += block.size();
  send(part.blocks, Numbers(elements, parallel::rank_of(comm)), part.position, nodes, mesh);
  return mesh;
}

FacetMesh numbered(std::vector<Block> blocks, const Part& part, const Nodes& nodes, MPI_Comm comm,
                   const InputError& foreign) {
  Numbers tags;
  for (const Block& block : blocks) tags.insert(tags.end(), block.node.begin(), block.node.end());
  tags = united(comm, tags);
  for (Block& block : blocks)
    for (std::int64_t& node : block.node)
      node = std::lower_bound(tags.begin(), tags.end(), node) - tags.begin();
  // Only the owner of a node contributes its values: number, position and 1.
  constexpr std::size_t width = 5;
  std::vector<double> values(width * tags.size(), 0);
  for (std::size_t i = 0; i < tags.size(); ++i) {
    const auto n = static_cast<std::size_t>(std::lower_bound(part.tag.begin(), part.tag.end(), tags[i]) -
                                            part.tag.begin());
    if (n == part.tag.size() || part.tag[n] != tags[i] || nodes.owner[n] != parallel::rank_of(comm)) continue;
    double* value = &values[width * i];
    value[0] = static_cast<double>(nodes.number[n]);
    std::copy_n(&part.position[3 * n], 3, value + 1);
    value[4] = 1;
  }
  parallel::sum(comm, values);
  FacetMesh facets;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    const double* value = &values[width * i];
    if (value[4] == 0) throw foreign;
    facets.node.push_back(static_cast<std::int64_t>(value[0]));
    facets.position.insert(facets.position.end(), value + 1, value + 4);
  }
  facets.blocks = std::move(blocks);
  return facets;
}

}  // namespace ricochet::mesh
