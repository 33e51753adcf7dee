// SPDX-License-Identifier: BSD-2-Clause
// Surfaces of obstacles from STL and OBJ files.
#pragma once

#include <filesystem>
#include <string>

#include "ricochet/scene.hpp"

namespace ricochet::contact {

/// Reads an STL file, text or binary, or a Wavefront OBJ file, by the ending .obj, and joins corners with
/// equal coordinates. Normals of the file are not used. Throws a one-line InputError if the file is missing
/// or of another kind. @param scale  of the coordinates
SurfaceMesh read_surface(const std::filesystem::path& path, double scale = 1);

/// Writes an STL file, as text with all digits, in a folder that exists. @param title  on its first line,
/// behind "solid". Throws InputError if it cannot be written.
void write_surface(const SurfaceMesh& mesh, const std::string& title, const std::filesystem::path& path);

/// The title of such a file; empty if there is none.
std::string title_of_surface(const std::filesystem::path& path);

}  // namespace ricochet::contact
