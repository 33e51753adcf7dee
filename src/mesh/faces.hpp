// SPDX-License-Identifier: BSD-2-Clause
// Faces of volume elements: the boundary of a body, its visualisation surface, and facets on the boundary.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// The nodes at the corners of a face.
using Corners = std::vector<std::int64_t>;
/// Faces by their sorted corners; the value has the corners in the order that points out of the body.
using Faces = std::map<Corners, Corners>;

/// Faces that belong to exactly one element.
Faces outside_of(const std::vector<Block>& blocks);

/// Adds a boundary face of one part to those of the other parts, or removes it if it coincides with one of
/// them.
void add_face(Faces& outside, Corners outward);

/// The faces, divided into triangles.
Block triangles_of(const Faces& outside);

/// Orients each facet of a surface of `body` outward. Throws InputError that names `key` of the scene if a
/// facet does not lie on the boundary, or if its order is not the `order` of the elements.
void orient(Block& facets, int order, const Faces& outside, const scene::Body& body, const std::string& key);

}  // namespace ricochet::mesh
