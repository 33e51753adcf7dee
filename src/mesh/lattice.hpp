// SPDX-License-Identifier: BSD-2-Clause
// The nodes of a Lagrange facet as a lattice: its subdivision into linear cells.
#pragma once

#include <array>
#include <vector>

#include "src/mesh/reference.hpp"

namespace ricochet::mesh {

/// Cells between the nodes of one facet (triangle, quadrangle, line): p² triangles, p² quadrangles or p
/// segments, oriented like the facet.
struct Lattice {
  int corners = 0;                        ///< per cell: 3, 4 or 2
  std::vector<std::array<int, 4>> cells;  ///< local node numbers; unused entries −1
  /// The cells as a flat list of triangles (two for a quadrangle), segments or points.
  std::vector<int> simplices() const;
  int simplex_corners() const { return corners == 4 ? 3 : corners; }
};

Lattice lattice_of(const ReferenceElement& facet);

}  // namespace ricochet::mesh
