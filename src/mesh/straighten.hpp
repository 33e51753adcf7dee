// SPDX-License-Identifier: BSD-2-Clause
// Curved elements that are inverted, and their straightening.
#pragma once

#include <cstdint>

#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// Number of curved volume elements whose Jacobian is not positive at every quadrature point of assembly.
/// Elements that are straight are not counted. Needs a GmshSession.
std::int64_t count_inverted(const GlobalMesh& mesh);

struct Straightened {
  std::int64_t elements = 0;
  double distance = 0;  ///< by which a node was moved at most [m]
};

/// Moves the nodes on edges, on faces and inside of inverted curved elements to where straight edges place
/// them. Neighbours share these nodes, and are straightened too if that inverts them. Needs a GmshSession.
Straightened straighten_inverted(GlobalMesh& mesh);

}  // namespace ricochet::mesh
