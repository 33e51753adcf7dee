// SPDX-License-Identifier: BSD-2-Clause
// Meshes and extents of bodies from gmsh in a process of its own, the program ricochet-mesh.
//
// gmsh may abort, crash, hang or end its process while it reads a drawing or meshes it: it throws through
// OpenMP regions, its readers trust files, and a script may call Exit. In a child process, each of these ends
// is one line of the parent.
#pragma once

#include "src/mesh/open.hpp"
#include "src/mesh/read.hpp"
#include "src/mesh/triangulate.hpp"

namespace ricochet::mesh {

/// Returns read_mesh(body, progress, asked). A .msh file is read in this process, because check_msh has
/// validated it before gmsh reads it; all others are read by a child. Needs a GmshSession.
/// Throws InputError like read_mesh, and if the child dies, takes more processor time than the environment
/// variable RICOCHET_MESH_SECONDS allows (3600 s by default), or more memory than is available or
/// RICOCHET_MESH_MIB allows. Throws std::runtime_error if ricochet-mesh cannot be started.
GlobalMesh read_mesh_apart(const scene::Body& body, const parallel::Progress& progress = {},
                           const RequestedGroups& asked = {});

/// Returns extent_of(body), likewise, and with the errors of gmsh as InputError.
Extent extent_apart(const scene::Body& body);

/// Returns triangulate(body) of a child, which also reads a .msh.
Triangulation triangulate_apart(const scene::Body& body);

/// The main function of ricochet-mesh: reads a request from stdin, writes the answer to stdout and the
/// messages of gmsh to stderr. @return the exit status
int answer_request();

}  // namespace ricochet::mesh
