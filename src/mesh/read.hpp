// SPDX-License-Identifier: BSD-2-Clause
// Reads mesh files and geometries through gmsh.
#pragma once

#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// Reads a mesh, or meshes a geometry. Rank 0 only; needs a GmshSession. Throws InputError if the file is
/// unreadable, a physical group is missing, there are no volume or line elements, contact facets lie inside
/// the body, gmsh did not reach the requested order, or a rod is bent.
GlobalMesh read_mesh(const scene::Body& body, const parallel::Progress& progress = {},
                     const RequestedGroups& asked = {});

}  // namespace ricochet::mesh
