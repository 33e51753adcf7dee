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
/// All nodes of a face, in the order of gmsh and such that its normal points out of the body. The first are
/// its corners.
using FaceNodes = std::vector<std::int64_t>;
/// Faces by their sorted corners.
using Faces = std::map<Corners, FaceNodes>;

/// Returns the faces that belong to exactly one element. Needs a GmshSession.
Faces outside_of(const std::vector<Block>& blocks);

/// Adds a boundary face of one part. If another part has added the same face, it lies between them and is
/// removed.
void add_face(Faces& outside, Corners corners, FaceNodes nodes);

/// Contact surface of this name: all faces in `outside`, unless the mesh has a physical surface of this name.
inline constexpr const char* whole_boundary = "all";

/// Returns the facets of `blocks` that are in `outside`, with all their nodes, oriented outward. Tags are
/// 6 t + f for face f of element t, which differ also between the parts of a mesh; labels are 0. Needs a
/// GmshSession.
/// @param outside  with nodes numbered as in `blocks`
std::vector<Block> boundary_of(const std::vector<Block>& blocks, const Faces& outside);

/// Removes the facets that are not in `outside`, which numbers nodes as `facets` does.
void keep_outside(Block& facets, const Faces& outside);

/// Divides faces of elements of this order into triangles: the blocks of a visualisation surface (FacetMesh).
/// Needs a GmshSession.
std::vector<Block> triangles_of(const Faces& outside, int order);
/// The same for facets that face outward.
std::vector<Block> triangles_of(const std::vector<Block>& facets);

/// Restricts a visualisation surface to the corners of its faces.
void keep_corners(FacetMesh& surface);

/// Orients each facet of a surface of `body` outward. Throws InputError if a facet does not lie on the
/// boundary, in which case the message names `key` of the scene, or if its order differs from the `order` of
/// the elements.
void orient(Block& facets, int order, const Faces& outside, const scene::Body& body, const std::string& key);

}  // namespace ricochet::mesh
