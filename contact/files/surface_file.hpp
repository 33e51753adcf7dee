// SPDX-License-Identifier: BSD-2-Clause
// Surfaces of obstacles from STL files.
#pragma once

#include <filesystem>

#include "ricochet/scene.hpp"

namespace ricochet::contact {

/// Reads an STL file, text or binary, and joins corners with equal coordinates. Normals of the file are not
/// used. Throws a one-line InputError if the file is missing or no STL file. @param scale  of the coordinates
SurfaceMesh read_surface(const std::filesystem::path& path, double scale = 1);

}  // namespace ricochet::contact
