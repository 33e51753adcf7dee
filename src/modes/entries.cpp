// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/entries.hpp"

#include <metis.h>

#include "src/parallel/parallel.hpp"

namespace ricochet::modes {

using parallel::check;

Entries::Entries(Mat stiffness_matrix, Mat mass_matrix) {
  PetscInt begin = 0, end = 0, total = 0, nodal = 1;
  check(MatGetOwnershipRange(stiffness_matrix, &begin, &end));
  check(MatGetSize(stiffness_matrix, &total, nullptr));
  check(MatGetBlockSize(stiffness_matrix, &nodal));
  rows = total;
  local_rows = end - begin;
  first = begin;
  block = static_cast<int>(nodal);
  for (Mat matrix : {stiffness_matrix, mass_matrix}) {
    const bool is_mass = matrix == mass_matrix;
    std::vector<double>& value = is_mass ? mass : stiffness;
    check(MatGetRowUpperTriangular(matrix));
    for (PetscInt i = begin; i < end; ++i) {
      PetscInt n = 0;
      const PetscInt* columns = nullptr;
      const double* entry = nullptr;
      check(MatGetRow(matrix, i, &n, &columns, &entry));
      for (PetscInt k = 0; k < n; ++k) {
        if (columns[k] < i) continue;
        value.push_back(entry[k]);
        if (is_mass) continue;
        row.push_back(static_cast<int>(i) + 1);
        column.push_back(static_cast<int>(columns[k]) + 1);
      }
      check(MatRestoreRow(matrix, i, &n, &columns, &entry));
    }
    check(MatRestoreRowUpperTriangular(matrix));
  }
  if (mass.size() != stiffness.size()) throw SolverError("internal: K and M differ in their pattern");
}

std::vector<int> order_of_elimination(MPI_Comm comm, const Entries& entries) {
  const int block = entries.block;
  // Edges between nodes, one for each block, gathered on the first rank.
  std::vector<int> edge;
  for (std::size_t k = 0; k < entries.row.size(); ++k) {
    const int i = entries.row[k] - 1, j = entries.column[k] - 1;
    if (i % block == 0 && j % block == 0 && i != j) edge.insert(edge.end(), {i / block, j / block});
  }
  edge = parallel::gather(comm, edge);
  if (parallel::rank_of(comm) != 0) return {};

  // The graph contains each edge at both of its ends.
  const auto nodes = static_cast<std::size_t>(entries.rows / block);
  std::vector<idx_t> start(nodes + 1, 0), neighbour(edge.size());
  for (int node : edge) ++start[static_cast<std::size_t>(node) + 1];
  for (std::size_t i = 0; i < nodes; ++i) start[i + 1] += start[i];
  std::vector<idx_t> next(start.begin(), start.end() - 1);
  for (std::size_t k = 0; k < edge.size(); k += 2) {
    neighbour[static_cast<std::size_t>(next[static_cast<std::size_t>(edge[k])]++)] = edge[k + 1];
    neighbour[static_cast<std::size_t>(next[static_cast<std::size_t>(edge[k + 1])]++)] = edge[k];
  }
  auto n = static_cast<idx_t>(nodes);
  std::vector<idx_t> order(static_cast<std::size_t>(n)), place(order.size());
  if (neighbour.empty()) {
    for (idx_t i = 0; i < n; ++i) place[static_cast<std::size_t>(i)] = i;
  } else {
    idx_t options[METIS_NOPTIONS];
    METIS_SetDefaultOptions(options);
    if (METIS_NodeND(&n, start.data(), neighbour.data(), nullptr, options, order.data(), place.data()) !=
        METIS_OK)
      throw SolverError("METIS could not order the nodes");
  }
  std::vector<int> places;
  for (idx_t p : place)
    for (int c = 0; c < block; ++c) places.push_back(static_cast<int>(p) * block + c + 1);
  return places;
}

}  // namespace ricochet::modes
