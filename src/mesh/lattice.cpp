// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/lattice.hpp"

#include <cmath>
#include <map>

#include "ricochet/error.hpp"

namespace ricochet::mesh {

std::vector<int> Lattice::simplices() const {
  std::vector<int> flat;
  for (const auto& cell : cells) {
    if (corners == 4) {
      flat.insert(flat.end(), {cell[0], cell[1], cell[2], cell[0], cell[2], cell[3]});
    } else {
      flat.insert(flat.end(), cell.begin(), cell.begin() + corners);
    }
  }
  return flat;
}

Lattice lattice_of(const ReferenceElement& facet) {
  const int p = facet.order;
  Lattice lattice;
  if (facet.family == Family::point) {
    lattice.corners = 1;
    lattice.cells = {{0, -1, -1, -1}};
    return lattice;
  }
  // In gmsh, lines and quadrangles have coordinates in [−1, 1], triangles in [0, 1].
  const bool simplex = facet.family == Family::triangle;
  std::map<std::array<int, 2>, int> at;
  for (int n = 0; n < facet.nodes; ++n) {
    std::array<int, 2> index{0, 0};
    for (int d = 0; d < facet.dim; ++d) {
      const double x = facet.node[static_cast<std::size_t>(n) * facet.dim + d];
      index[d] = static_cast<int>(std::lround((simplex ? x : (x + 1) / 2) * p));
    }
    at[index] = n;
  }
  if (static_cast<int>(at.size()) != facet.nodes)
    throw SolverError("internal: facet nodes do not form a lattice");

  if (facet.family == Family::line) {
    lattice.corners = 2;
    for (int i = 0; i < p; ++i) lattice.cells.push_back({at[{i, 0}], at[{i + 1, 0}], -1, -1});
  } else if (facet.family == Family::quadrangle) {
    lattice.corners = 4;
    for (int j = 0; j < p; ++j)
      for (int i = 0; i < p; ++i)
        lattice.cells.push_back({at[{i, j}], at[{i + 1, j}], at[{i + 1, j + 1}], at[{i, j + 1}]});
  } else {
    lattice.corners = 3;
    for (int j = 0; j < p; ++j)
      for (int i = 0; i + j < p; ++i) {
        lattice.cells.push_back({at[{i, j}], at[{i + 1, j}], at[{i, j + 1}], -1});
        if (i + j + 1 < p) lattice.cells.push_back({at[{i + 1, j}], at[{i + 1, j + 1}], at[{i, j + 1}], -1});
      }
  }
  return lattice;
}

}  // namespace ricochet::mesh
