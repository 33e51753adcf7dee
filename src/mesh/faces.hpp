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
/// Faces by their sorted corners. The value lists the corners such that the normal points out of the body.
using Faces = std::map<Corners, Corners>;

/// Returns the faces that belong to exactly one element.
Faces outside_of(const std::vector<Block>& blocks);

/// Adds a boundary face of one part. If another part has added the same face, it lies between them and is
/// removed.
void add_face(Faces& outside, Corners outward);

/// Contact surface of this name: all faces in `outside`, unless the mesh has a physical surface of this name.
inline constexpr const char* whole_boundary = "all";

/// Returns the facets of `blocks` that are in `outside`, with all their nodes, oriented outward. Tags are
/// 6 t + f for face f of element t, which differ also between the parts of a mesh; labels are 0. Needs a
/// GmshSession.
/// @param outside  with nodes numbered as in `blocks`
std::vector<Block> boundary_of(const std::vector<Block>& blocks, const Faces& outside);

/// Removes the facets that are not in `outside`, which numbers nodes as `facets` does.
void keep_outside(Block& facets, const Faces& outside);

/// Divides the faces into triangles.
Block triangles_of(const Faces& outside);

/// Orients each facet of a surface of `body` outward. Throws InputError if a facet does not lie on the
/// boundary, in which case the message names `key` of the scene, or if its order differs from the `order` of
/// the elements.
void orient(Block& facets, int order, const Faces& outside, const scene::Body& body, const std::string& key);

}  // namespace ricochet::mesh
