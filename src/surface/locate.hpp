// SPDX-License-Identifier: BSD-2-Clause
// Locates points in a body.
#pragma once

#include <vector>

#include "src/mesh/mesh.hpp"

namespace ricochet::surface {

/// The position in a body nearest to a point, as a combination of nodes. The displacement at the position is
/// Σ weight · u.
struct Located {
  std::vector<std::int64_t> node;  ///< global
  std::vector<double> weight;      ///< shape functions of the element that contains the position
  /// Linear shape functions of the corners, which come first among the nodes; empty without elements.
  std::vector<double> corner_weight{};
  std::int64_t label = -1;  ///< of the element, as in mesh::Block
  Vector3 place{};          ///< the position [m]
  double distance = 0;      ///< from the point to the position [m]; 0 to round-off if the point is inside
};

/// Locates `point`; the result is the same on every rank. For a body without elements, the position is the
/// nearest node. Needs a GmshSession. Collective.
Located locate(const mesh::Mesh& mesh, const Vector3& point);

/// Nodes of the mesh as positions, in an element of the lowest label; the same on every rank. The body must
/// have elements. Collective.
/// @param nodes  global, the same on every rank
std::vector<Located> at_nodes(const mesh::Mesh& mesh, const std::vector<std::int64_t>& nodes);

/// Diagonal of the bounding box [m]. Collective.
double size_of(const mesh::Mesh& mesh);

}  // namespace ricochet::surface
