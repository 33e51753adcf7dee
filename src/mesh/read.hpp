// SPDX-License-Identifier: BSD-2-Clause
// A mesh file or a geometry, read through gmsh.
#pragma once

#include "src/mesh/mesh.hpp"
#include "src/mesh/part.hpp"

namespace ricochet::mesh {

/// Reads a mesh or meshes a geometry. Rank 0 only; needs a GmshSession made with the body's geometry values.
/// Throws InputError: unreadable file, missing physical group, no volume elements, contact facets inside the
/// body, an order that gmsh could not reach, a bent rod.
GlobalMesh read_mesh(const scene::Body& body, const parallel::Progress& progress = {},
                     const Asked& asked = {});

/// Reads the file body.mesh as one of `parts`; needs a GmshSession. Throws InputError as read_mesh does, but
/// not for groups that the part does not have.
Part read_part(const scene::Body& body, int parts, const Asked& asked);

}  // namespace ricochet::mesh
