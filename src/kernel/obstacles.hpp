// SPDX-License-Identifier: BSD-2-Clause
// The triangles of obstacles that are given as drawings.
#pragma once

#include <mpi.h>

#include <filesystem>

#include "src/console/console.hpp"

namespace ricochet::scene {
struct Scene;
}

namespace ricochet::kernel {

/// Lets gmsh make the triangles of the scene's drawn obstacles that are not in the folder yet, states how far
/// their curved surface is from the drawing, and sets them in the scene. Collective. Throws InputError on
/// every rank if gmsh refuses a drawing, or if its surface is not closed.
void make_surfaces(scene::Scene& scene, const std::filesystem::path& folder, MPI_Comm comm,
                   console::Console& console);

}  // namespace ricochet::kernel
