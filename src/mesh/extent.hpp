// SPDX-License-Identifier: BSD-2-Clause
// The extent of a body and of its supports, from its distributed mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// The nodes that lie farthest out in each of several hundred directions, without duplicates. They are the
/// vertices of a convex body; of a ball of radius r they cover all but 0.01 r.
/// @return (H,3) [m], the same on every rank and for any number of ranks. Collective.
std::vector<double> outline_of(const Mesh& mesh);

/// Bit c is set if supports of a solid hold component c, but nowhere on all nodes of a face of an element:
/// then they are lines or points, under which the displacement has no limit as the mesh is refined. 0 for
/// rods and for bodies without elements. Collective. Needs a GmshSession.
std::int64_t held_on_lines(const Mesh& mesh);

/// Area of the boundary of a solid with elements [m²], with edges of faces taken as straight. Collective.
/// Needs a GmshSession.
double surface_of(const Mesh& mesh);

}  // namespace ricochet::mesh
