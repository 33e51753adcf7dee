// SPDX-License-Identifier: BSD-2-Clause
// The triangles that gmsh makes of drawings of obstacles: STL files beside the kernels.
#pragma once

#include <filesystem>
#include <optional>

#include "ricochet/scene.hpp"

namespace ricochet::scene {
struct Scene;
}

namespace ricochet::store {

/// Stores the triangles of an obstacle at scene::surface_path, in the units of its drawing.
/// @param deviation  their largest distance from the drawing, likewise
/// Throws InputError if the file cannot be written.
void write_surface(const SurfaceMesh& mesh, double deviation, const std::filesystem::path& path);

/// The deviation of a stored surface, in the units of the file; no value if it is not there.
std::optional<double> stored_deviation(const std::filesystem::path& path);

/// The file of the first obstacle whose triangles are not in the folder. Throws InputError if a drawing
/// cannot be read.
std::optional<std::filesystem::path> missing_surface(const scene::Scene& scene,
                                                     const std::filesystem::path& folder);

/// Sets `triangles` and `deviation` of each obstacle with a drawing. Throws InputError if its triangles are
/// not in the folder.
void find_surfaces(scene::Scene& scene, const std::filesystem::path& folder);

}  // namespace ricochet::store
