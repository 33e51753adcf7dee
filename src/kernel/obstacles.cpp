// SPDX-License-Identifier: BSD-2-Clause
#include "src/kernel/obstacles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "base/atomic_file.hpp"
#include "contact/pairing/rigid_surface.hpp"
#include "src/mesh/apart.hpp"
#include "src/parallel/parallel.hpp"
#include "src/scene/request.hpp"
#include "src/scene/scene.hpp"
#include "src/store/surfaces.hpp"

namespace ricochet::kernel {
namespace fs = std::filesystem;

namespace {

/// Points of a drawing by which its distance from the triangles is measured, at most.
constexpr std::size_t most_measured = 20'000;

/// The largest distance of points of a drawing from the surface that contact makes of its triangles.
double deviation_of(const contact::RigidMesh& triangles, const std::vector<double>& exact) {
  const contact::SurfaceProjection surface(contact::rigid_surface(triangles));
  const std::size_t points = exact.size() / 3, every = points / most_measured + 1;
  double farthest = 0;
  for (std::size_t k = 0; k < points; k += every) {
    const Eigen::Vector3d x = Eigen::Map<const Eigen::Vector3d>(&exact[3 * k]);
    if (const auto y = surface.closest(x))
      farthest = std::max(farthest, std::abs(y->normal.dot(x - y->point)));
  }
  return farthest;
}

/// What there is to report of a surface.
struct Report {
  std::string note, warning;
};

/// Makes and stores the triangles of one obstacle.
Report make_surface(const scene::Scene& scene, const scene::Obstacle& obstacle, const fs::path& path) {
  base::check_place(path);
  scene::Body drawing;
  drawing.name = obstacle.name;
  drawing.mesh = obstacle.surface;
  drawing.size_factor = obstacle.size_factor;
  drawing.order = 1;
  const mesh::Triangulation made = mesh::triangulate_apart(drawing);
  contact::RigidMesh triangles;
  for (std::size_t n = 0; n < made.position.size(); n += 3)
    triangles.node.emplace_back(made.position[n], made.position[n + 1], made.position[n + 2]);
  for (std::size_t t = 0; t < made.triangle.size(); t += 3)
    triangles.triangle.push_back({static_cast<int>(made.triangle[t]), static_cast<int>(made.triangle[t + 1]),
                                  static_cast<int>(made.triangle[t + 2])});
  if (const std::string flaw = contact::flaw_of(triangles); !flaw.empty())
    throw InputError(fmt::format("{}: obstacles.{}.surface: {} {}, in its units: export it as one solid",
                                 scene.file.filename().string(), obstacle.name,
                                 obstacle.surface.filename().string(), flaw));
  SurfaceMesh out;
  for (const Eigen::Vector3d& x : triangles.node) out.node.push_back({x.x(), x.y(), x.z()});
  for (const auto& t : triangles.triangle)
    out.triangle.push_back({static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]),
                            static_cast<std::uint32_t>(t[2])});
  const double deviation = deviation_of(triangles, made.exact);
  store::write_surface(out, deviation, path);
  return {made.exact.empty() ? fmt::format("{} triangles of a mesh", out.triangle.size())
                             : fmt::format("{} triangles, up to {:.2g} m from the drawing",
                                           out.triangle.size(), obstacle.scale * deviation),
          made.sewn};
}

}  // namespace

void make_surfaces(scene::Scene& scene, const fs::path& folder, MPI_Comm comm, console::Console& console) {
  for (const scene::Obstacle& obstacle : scene.obstacles) {
    if (!obstacle.is_drawn()) continue;
    fs::path path;
    bool there = false;
    parallel::on_first_rank(comm, [&] {
      path = scene::surface_path(folder, scene, obstacle);
      there = store::stored_deviation(path).has_value();
    });
    if (parallel::of_rank(comm, 0, there)) continue;
    console.begin(obstacle.name + ": surface");
    Report report;
    parallel::on_first_rank(comm, [&] { report = make_surface(scene, obstacle, path); });
    console.end(report.note);
    if (!report.warning.empty()) console.warn(report.warning);
    console.say(fmt::format("{}: {}", obstacle.name, path.string()));
  }
  parallel::on_all_ranks(comm, [&] { store::find_surfaces(scene, folder); });
}

}  // namespace ricochet::kernel
