// SPDX-License-Identifier: BSD-2-Clause
// Reads a mesh in parallel, from one file or from one file per part.
#pragma once

#include "src/mesh/mesh.hpp"
#include "src/mesh/msh_files.hpp"

namespace ricochet::mesh {

/// Reads a mesh and sends to each rank of `team` the elements that touch its nodes. Each rank reads an equal
/// range of each list of the files; rank 0 also holds the surfaces. Needs a GmshSession. Collective.
/// Throws InputError on every rank for the reasons of read_mesh, and if parts do not fit together.
/// @param peers  ranks in the same place of other teams, which hold the same nodes and elements
Mesh read_msh(const MshFiles& files, const scene::Body& body, MPI_Comm team, MPI_Comm peers,
              const parallel::Progress& progress = {}, const RequestedGroups& asked = {});

}  // namespace ricochet::mesh
