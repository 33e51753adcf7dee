// SPDX-License-Identifier: BSD-2-Clause
#include "src/store/surfaces.hpp"

#include <fmt/format.h>

#include <charconv>

#include "contact/files/surface_file.hpp"
#include "ricochet/error.hpp"
#include "src/scene/request.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::store {
namespace fs = std::filesystem;

namespace {

constexpr std::string_view title = "by ricochet-kernel, deviation ";

}  // namespace

void write_surface(const SurfaceMesh& mesh, double deviation, const fs::path& path) {
  contact::write_surface(mesh, fmt::format("{}{}", title, deviation), path);
}

std::optional<double> stored_deviation(const fs::path& path) {
  const std::string found = contact::title_of_surface(path);
  double deviation = 0;
  if (!found.starts_with(title) ||
      std::from_chars(found.data() + title.size(), found.data() + found.size(), deviation).ec != std::errc())
    return std::nullopt;
  return deviation;
}

std::optional<fs::path> missing_surface(const scene::Scene& scene, const fs::path& folder) {
  for (const scene::Obstacle& obstacle : scene.obstacles) {
    if (!obstacle.is_drawn()) continue;
    const fs::path path = scene::surface_path(folder, scene, obstacle);
    if (!stored_deviation(path)) return path;
  }
  return std::nullopt;
}

void find_surfaces(scene::Scene& scene, const fs::path& folder) {
  for (scene::Obstacle& obstacle : scene.obstacles) {
    if (!obstacle.is_drawn()) continue;
    const fs::path path = scene::surface_path(folder, scene, obstacle);
    const auto deviation = stored_deviation(path);
    if (!deviation)
      throw InputError(fmt::format(
          "{}: obstacles.{}.surface: the triangles of {} are not at {}. Run ricochet-kernel {} first, which "
          "makes them with gmsh, with the same --set and --out.",
          scene.file.string(), obstacle.name, obstacle.surface.filename().string(), path.string(),
          scene.file.string()));
    obstacle.triangles = path;
    obstacle.deviation = obstacle.scale * *deviation;
  }
}

}  // namespace ricochet::store
