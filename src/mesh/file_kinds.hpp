// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/mesh: kinds of meshes and drawings, by the extensions of their files.
#pragma once

#include <filesystem>

namespace ricochet::mesh {

/// Throws InputError unless gmsh reads files with this extension; it takes all others for scripts in its own
/// language. The message names the software that reads the file.
void check_kind(const std::filesystem::path& file);

/// Whether the file is of a kind of geometry, which gmsh meshes, and not a mesh.
bool is_drawing(const std::filesystem::path& file);

/// Whether the file is of a kind that holds triangles of a surface alone.
bool is_surface(const std::filesystem::path& file);

}  // namespace ricochet::mesh
