// SPDX-License-Identifier: BSD-2-Clause
// A mesh file or a geometry, read through gmsh.
#pragma once

#include "src/mesh/mesh.hpp"
#include "src/mesh/part.hpp"

namespace ricochet::mesh {

/// Reads a mesh, or meshes a geometry. Rank 0 only; needs a GmshSession made with the geometry values of the
/// body. Throws InputError: unreadable file, missing physical group, no volume elements, contact facets
/// inside the body, an order that gmsh could not reach, a bent rod.
GlobalMesh read_mesh(const scene::Body& body, const parallel::Progress& progress = {},
                     const RequestedGroups& asked = {});

/// Reads the file body.mesh as one of `parts` parts; needs a GmshSession. Throws InputError like read_mesh,
/// except for groups that the part does not contain.
Part read_part(const scene::Body& body, int parts, const RequestedGroups& asked);

}  // namespace ricochet::mesh
