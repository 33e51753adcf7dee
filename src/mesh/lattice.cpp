// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/lattice.hpp"

#include <cmath>
#include <map>

#include "ricochet/error.hpp"

namespace ricochet::mesh {

std::vector<int> Lattice::triangles() const {
  std::vector<int> flat;
  for (const auto& cell : cells) {
    flat.insert(flat.end(), cell.begin(), cell.begin() + 3);
    if (corners == 4) flat.insert(flat.end(), {cell[0], cell[2], cell[3]});
  }
  return flat;
}

Lattice lattice_of(const ReferenceElement& facet) {
  const int p = facet.order;
  // In gmsh, quadrangles have coordinates in [−1, 1], triangles in [0, 1].
  const bool simplex = facet.family == Family::triangle;
  std::map<std::array<int, 2>, int> at;
  for (int n = 0; n < facet.nodes; ++n) {
    std::array<int, 2> index{};
    for (int d = 0; d < 2; ++d) {
      const double x = facet.node[2 * static_cast<std::size_t>(n) + d];
      index[d] = static_cast<int>(std::lround((simplex ? x : (x + 1) / 2) * p));
    }
    at[index] = n;
  }
  if (static_cast<int>(at.size()) != facet.nodes)
    throw SolverError("internal: facet nodes do not form a lattice");
  Lattice lattice;
  lattice.corners = simplex ? 3 : 4;
  for (int j = 0; j < p; ++j)
    for (int i = 0; i < (simplex ? p - j : p); ++i) {
      const int first = at[{i, j}], right = at[{i + 1, j}], up = at[{i, j + 1}];
      if (!simplex) {
        lattice.cells.push_back({first, right, at[{i + 1, j + 1}], up});
        continue;
      }
      lattice.cells.push_back({first, right, up, -1});
      if (i + j + 1 < p) lattice.cells.push_back({right, at[{i + 1, j + 1}], up, -1});
    }
  return lattice;
}

}  // namespace ricochet::mesh
