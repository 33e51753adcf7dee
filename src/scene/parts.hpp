// SPDX-License-Identifier: BSD-2-Clause
// Meshes in several files.
#pragma once

#include <filesystem>
#include <vector>

namespace ricochet::scene {

/// Returns the files body_1.msh, body_2.msh… of a mesh body.msh that gmsh partitioned, in this order. Returns
/// an empty list if the mesh itself exists or the first part does not. Throws InputError if a part between
/// the first and the last is missing.
std::vector<std::filesystem::path> part_files(const std::filesystem::path& mesh);

}  // namespace ricochet::scene
