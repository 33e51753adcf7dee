// SPDX-License-Identifier: BSD-2-Clause
// Meshes in several files.
#pragma once

#include <filesystem>
#include <vector>

namespace ricochet::scene {

/// The parts body_1.msh, body_2.msh… of a mesh body.msh that gmsh split, in this order. Empty where the mesh
/// is there itself or has no first part. Throws InputError when one between the first and the last is
/// missing.
std::vector<std::filesystem::path> part_files(const std::filesystem::path& mesh);

}  // namespace ricochet::scene
