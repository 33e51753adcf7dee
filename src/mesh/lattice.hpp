// SPDX-License-Identifier: BSD-2-Clause
// The nodes of a Lagrange facet as a lattice: its subdivision into linear cells.
#pragma once

#include <array>
#include <vector>

#include "src/mesh/reference.hpp"

namespace ricochet::mesh {

/// Cells between the nodes of one facet: p² triangles or quadrangles, oriented like the facet.
struct Lattice {
  int corners = 0;                        ///< per cell: 3 or 4
  std::vector<std::array<int, 4>> cells;  ///< local node numbers; of a triangle, the last is −1
  /// The cells as a flat list of triangles, two for a quadrangle.
  std::vector<int> triangles() const;
};

/// @param facet  a triangle or a quadrangle
Lattice lattice_of(const ReferenceElement& facet);

}  // namespace ricochet::mesh
