// SPDX-License-Identifier: BSD-2-Clause
// Meshes in several files.
#pragma once

#include <filesystem>
#include <vector>

namespace ricochet::scene {

/// The files body_1.msh, body_2.msh… of a mesh body.msh that gmsh partitioned, in this order. Empty if the
/// mesh itself exists or there is no first part. Throws InputError if a part between the first and the last
/// is missing.
std::vector<std::filesystem::path> part_files(const std::filesystem::path& mesh);

}  // namespace ricochet::scene
