// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/mesh: solids from the loose faces of a drawing, as many .iges hold them.
#pragma once

#include <filesystem>
#include <string>

namespace ricochet::mesh {

/// Reads the drawing of gmsh's current model again and joins its faces, if it has faces and no volume. Their
/// edges may be apart by a tolerance, the smallest that closes a volume, up to 1e-5 of the drawing.
/// @return what was joined, for the user; empty if the drawing needs none
/// Throws InputError with the number of free edges if the faces enclose no volume.
std::string sew_faces(const std::filesystem::path& drawing);

}  // namespace ricochet::mesh
