// SPDX-License-Identifier: BSD-2-Clause
// Meshes of other programs in a scene: ricochet import mesh converts them.
#pragma once

#include <mpi.h>

#include <filesystem>

#include "src/console/console.hpp"

namespace ricochet::scene {
struct Scene;
}

namespace ricochet::kernel {

/// Converts the foreign meshes of a scene by the command `ricochet import mesh` on the first rank, unless
/// their .msh is in the folder already, and sets Body::converted. Collective. Throws InputError on every rank
/// if a file is refused, or if its body has no material; the message then names those of the file.
void import_meshes(scene::Scene& scene, const std::filesystem::path& folder, MPI_Comm comm,
                   console::Console& console);

}  // namespace ricochet::kernel
