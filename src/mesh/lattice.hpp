// SPDX-License-Identifier: BSD-2-Clause
// Subdivision of a Lagrange facet into linear cells between its nodes.
#pragma once

#include <array>
#include <vector>

#include "src/mesh/reference.hpp"

namespace ricochet::mesh {

/// Cells between the nodes of one facet: p² triangles or quadrangles, oriented like the facet.
struct Lattice {
  int corners = 0;                        ///< per cell: 3 or 4
  std::vector<std::array<int, 4>> cells;  ///< local node numbers; −1 as the last one of a triangle
  /// Returns the cells as a flat list of triangles, two for each quadrangle.
  std::vector<int> triangles() const;
};

/// Subdivides a facet.
/// @param facet  a triangle or a quadrangle
Lattice lattice_of(const ReferenceElement& facet);

}  // namespace ricochet::mesh
