// SPDX-License-Identifier: BSD-2-Clause
// Faces of volume elements: the outside of a body, its skin, and facets that lie on it.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// Nodes at the corners of a face.
using Corners = std::vector<std::int64_t>;
/// Faces by their sorted corners: the corners in the order that points out of the body.
using Faces = std::map<Corners, Corners>;

/// Faces that belong to one of the elements only.
Faces outside_of(const std::vector<Block>& blocks);

/// Adds a face of a part of the body to those outside the other parts, or takes it out where it meets one.
void add_face(Faces& outside, Corners outward);

/// The faces cut into triangles.
Block triangles_of(const Faces& outside);

/// Turns each facet of a surface of `body` outward. Throws InputError naming the scene's `key` where one does
/// not lie outside, or where they are not of the `order` of the body's elements.
void orient(Block& facets, int order, const Faces& outside, const scene::Body& body, const std::string& key);

}  // namespace ricochet::mesh
