// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/split.hpp"

#include <petscmat.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "src/mesh/send.hpp"

static_assert(PetscDefined(HAVE_PTSCOTCH), "ricochet needs a build of PETSc with PT-Scotch");

namespace ricochet::mesh {

namespace {

using parallel::check;

/// Elements for each rank below which a mesh is not worth a graph.
constexpr std::int64_t few = 8;

/// The corners of a face in ascending order, −1 before those of a triangle, and the number of its element.
using ElementFace = std::array<std::int64_t, 5>;
/// The numbers of two elements that share a face.
using Edge = std::array<std::int64_t, 2>;

template <class Record>
std::vector<Record> sorted_records(MPI_Comm comm, const std::vector<Numbers>& to) {
  std::vector<Record> all;
  for (const Numbers& list : parallel::exchange(comm, to))
    for (std::size_t k = 0; k < list.size(); k += std::tuple_size_v<Record>) {
      Record& one = all.emplace_back();
      std::copy_n(&list[k], one.size(), one.begin());
    }
  std::ranges::sort(all);
  return all;
}

/// Sends each face to the rank on which those with the same corners meet.
/// @param number  of the first element of this rank
std::vector<ElementFace> meet(const std::vector<Block>& blocks, std::int64_t number, MPI_Comm comm) {
  std::vector<Numbers> to(static_cast<std::size_t>(parallel::size_of(comm)));
  for (const Block& block : blocks) {
    const auto pattern = outward_faces(reference_element(block.gmsh_type).family);
    for (std::size_t e = 0; e < block.size(); ++e, ++number)
      for (const std::vector<int>& corners : pattern) {
        ElementFace face{-1, -1, -1, -1, number};
        for (std::size_t c = 0; c < corners.size(); ++c)
          face[c] = block.node[e * static_cast<std::size_t>(block.nodes_per_element) +
                               static_cast<std::size_t>(corners[c])];
        std::sort(face.begin(), face.begin() + 4);
        // The sum is the same for all elements at the face, and spreads faces evenly over the ranks.
        const std::int64_t sum = std::accumulate(face.begin(), face.begin() + 4, std::int64_t{4});
        Numbers& list = to[static_cast<std::size_t>(sum) % to.size()];
        list.insert(list.end(), face.begin(), face.end());
      }
  }
  return sorted_records<ElementFace>(comm, to);
}

/// The pairs of elements that share a face, sorted, on the rank of the first one of a pair.
/// @param end  (ranks) number after the last element of each rank
std::vector<Edge> edges_between(const std::vector<ElementFace>& faces, const Numbers& end, MPI_Comm comm) {
  std::vector<Numbers> to(end.size());
  for (std::size_t k = 1; k < faces.size(); ++k) {
    const ElementFace &one = faces[k - 1], &other = faces[k];
    if (!std::equal(one.begin(), one.begin() + 4, other.begin())) continue;
    for (const Edge& edge : {Edge{one[4], other[4]}, Edge{other[4], one[4]}}) {
      const auto rank = std::ranges::upper_bound(end, edge[0]) - end.begin();
      Numbers& list = to[static_cast<std::size_t>(rank)];
      list.insert(list.end(), edge.begin(), edge.end());
    }
  }
  std::vector<Edge> edges = sorted_records<Edge>(comm, to);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

/// The graph with these edges. @param first, count  of the elements of this rank
parallel::Matrix graph_of(const std::vector<Edge>& edges, std::int64_t first, std::int64_t count,
                          std::int64_t total, MPI_Comm comm) {
  PetscInt *start = nullptr, *neighbour = nullptr;  // owned by the matrix
  check(PetscMalloc1(static_cast<std::size_t>(count) + 1, &start));
  check(PetscMalloc1(edges.size(), &neighbour));
  std::fill_n(start, count + 1, 0);
  for (std::size_t k = 0; k < edges.size(); ++k) {
    ++start[edges[k][0] - first + 1];
    neighbour[k] = parallel::petsc_int(edges[k][1]);
  }
  std::partial_sum(start, start + count + 1, start);
  parallel::Matrix graph;
  check(MatCreateMPIAdj(comm, parallel::petsc_int(count), parallel::petsc_int(total), start, neighbour,
                        nullptr, graph.out()));
  return graph;
}

/// Chooses the rank of each element of this rank.
Numbers rank_of_each(const std::vector<Block>& blocks, MPI_Comm comm) {
  std::int64_t count = 0;
  bool faces = false;
  for (const Block& block : blocks) {
    count += std::ssize(block.tag);
    faces = faces || !outward_faces(reference_element(block.gmsh_type).family).empty();
  }
  const auto ranks = static_cast<std::size_t>(parallel::size_of(comm));
  const std::int64_t first = parallel::sum_before(comm, count), last = first + count;
  Numbers end(ranks);
  MPI_Allgather(&last, 1, MPI_INT64_T, end.data(), 1, MPI_INT64_T, comm);
  if (ranks == 1 || !faces || end.back() < few * std::ssize(end)) {
    Numbers in_order(static_cast<std::size_t>(count));
    for (std::int64_t e = first; e < last; ++e)
      in_order[static_cast<std::size_t>(e - first)] = e * std::ssize(end) / end.back();
    return in_order;
  }
  const parallel::Matrix graph =
      graph_of(edges_between(meet(blocks, first, comm), end, comm), first, count, end.back(), comm);
  parallel::Handle<MatPartitioning, MatPartitioningDestroy> method;
  check(MatPartitioningCreate(comm, method.out()));
  check(MatPartitioningSetAdjacency(method, graph));
  check(MatPartitioningSetType(method, MATPARTITIONINGPTSCOTCH));
  parallel::Handle<IS, ISDestroy> parts;
  check(MatPartitioningApply(method, parts.out()));
  const PetscInt* part = nullptr;
  check(ISGetIndices(parts, &part));
  Numbers rank(part, part + count);
  check(ISRestoreIndices(parts, &part));
  return rank;
}

}  // namespace

std::vector<Block> split(const std::vector<Block>& blocks, MPI_Comm comm, MPI_Comm peers) {
  // PT-Scotch need not find the same parts again.
  Numbers rank;
  if (parallel::rank_of(peers) == 0) rank = rank_of_each(blocks, comm);
  parallel::broadcast(peers, rank);
  return exchanged(blocks, rank, comm);
}

}  // namespace ricochet::mesh
