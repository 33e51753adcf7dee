// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/mesh: the order of nodes in elements that another program has written.
#pragma once

#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// Puts the nodes of elements into the order of gmsh if, as the file has them, elements are inverted, and in
/// another order none is. Programs number the nodes on edges differently, and some give their elements the
/// other orientation. The order of a block is that which puts the nodes of an element nearest to where
/// straight edges have them; it is taken only if the Jacobians of all elements are then positive.
/// Needs a GmshSession. @return number of corrected elements
std::int64_t correct_node_order(GlobalMesh& mesh);

}  // namespace ricochet::mesh
