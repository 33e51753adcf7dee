// SPDX-License-Identifier: BSD-2-Clause
// Where in a body a point lies.
#pragma once

#include <vector>

#include "src/mesh/mesh.hpp"

namespace ricochet::surface {

/// The place of a body nearest to a point, as a combination of nodes: a displacement there is Σ weight · u.
struct Located {
  std::vector<std::int64_t> node;  ///< global
  std::vector<double> weight;      ///< shape functions of the element that holds it
  Vector3 place{};                 ///< [m]
  double distance = 0;             ///< from the point to it [m]; 0 to round-off inside
};

/// The same on every rank; of a body without elements the nearest node. Needs a GmshSession. Collective.
Located locate(const mesh::Mesh& mesh, const Vector3& point);

/// Diagonal of the box around the body [m]. Collective.
double size_of(const mesh::Mesh& mesh);

}  // namespace ricochet::surface
