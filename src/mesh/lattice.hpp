// SPDX-License-Identifier: BSD-2-Clause
// The nodes of a Lagrange facet as a lattice: its subdivision into linear cells.
#pragma once

#include <array>
#include <vector>

#include "src/mesh/reference.hpp"

namespace ricochet::mesh {

/// Cells between the nodes of one facet (triangle, quadrangle, line): p² triangles, p² quadrangles or p
/// segments, with the facet's orientation.
struct Lattice {
  int corners = 0;                        ///< per cell: 3, 4 or 2
  std::vector<std::array<int, 4>> cells;  ///< local node numbers; unused entries −1
  /// Cells as triangles (a quadrangle gives two), segments or points, flat.
  std::vector<int> simplices() const;
  int simplex_corners() const { return corners == 4 ? 3 : corners; }
};

Lattice lattice_of(const ReferenceElement& facet);

}  // namespace ricochet::mesh
