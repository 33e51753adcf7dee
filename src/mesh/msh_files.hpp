// SPDX-License-Identifier: BSD-2-Clause
// The files of a mesh that all ranks read together.
#pragma once

#include <mpi.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "src/mesh/msh_outline.hpp"
#include "src/scene/data/body.hpp"

namespace ricochet::mesh {

/// A .msh file of version 4.1, or those of a mesh that gmsh saved as one file per part. The same on every
/// rank.
struct MshFiles {
  std::vector<std::filesystem::path> path;
  std::vector<MshOutline> outline;  ///< of each
  Entities entities;                ///< of all
  std::string warning;              ///< of the mesh, for the user; may be empty
};

/// Opens the mesh of a solid body. No value if the body is another one: a geometry, a mesh of another kind or
/// version, or a rod in one file. Needs a GmshSession. Collective; throws InputError on every rank if a file
/// is missing or its outline is refused, if it holds neither volumes nor a rod, or if parts are rods.
std::optional<MshFiles> open_msh(const scene::Body& body, MPI_Comm comm);

}  // namespace ricochet::mesh
