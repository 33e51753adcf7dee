// SPDX-License-Identifier: BSD-2-Clause
#include "src/programs/choose_modes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "src/mesh/gmsh_session.hpp"
#include "src/mesh/open.hpp"
#include "src/parallel/parallel.hpp"
#include "src/programs/kernel_candidates.hpp"
#include "src/scene/parts.hpp"

namespace ricochet {
namespace {

/// Crossings of the body by a wave within the shortest period of the band, at an accuracy of 1e-2. The number
/// grows with the inverse of the accuracy, for solids with its square root. The ends of rods meet with a
/// shock, which excites all modes.
constexpr double crossings = 2, crossings_of_rods = 15, reference = 1e-2;

/// Largest error of the flexibility; its effect on impacts is a few times smaller.
constexpr double most_flexibility_error = 0.1;

struct Waves {
  double rate;  ///< crossings of the body a second
  bool rod;
};

Waves waves(const scene::Scene& scene, const scene::Body& body) {
  scene::Body opened = body;
  if (const auto parts = scene::part_files(body.mesh); !parts.empty()) opened.mesh = parts.front();
  const mesh::GmshSession gmsh;
  mesh::Extent extent;
  mesh::with_gmsh_errors(body.mesh.filename().string(), [&] { extent = mesh::extent_of(opened); });
  double speed = 0;
  for (const scene::Material& material : body.materials)
    speed = std::max(speed, std::sqrt(material.young / material.density));
  if (!(extent.length > 0))
    throw InputError(
        fmt::format("{}: bodies.{}: no size is found in {}, so accuracy can't choose modes: give "
                    "modes.up_to_hz or modes.count",
                    scene.file.string(), body.name, body.mesh.filename().string()));
  return {speed / extent.length, extent.dimension == 1};
}

/// Rounded up to two digits, so that round-off does not change the band.
double rounded(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1);
  return std::ceil(value / unit - 1e-9) * unit;
}

}  // namespace

scene::Modes chosen_modes(const scene::Scene& scene, MPI_Comm comm) {
  double fastest = 0;
  std::vector<double> rate, rods;
  parallel::on_first_rank(comm, [&] {
    for (const scene::Body& body : scene.bodies) {
      const Waves found = waves(scene, body);
      rate.push_back(found.rate);
      rods.push_back(found.rod ? 1 : 0);
    }
  });
  parallel::broadcast(comm, rate);
  parallel::broadcast(comm, rods);
  for (const double each : rate) fastest = std::max(fastest, each);
  scene::Modes modes = scene.modes;
  const double finer = std::max(1.0, reference / *modes.accuracy);
  if (std::ranges::count(rods, 1.0) == std::ssize(rods)) {
    modes.basis = scene::Basis::modes;
    modes.up_to = Hertz{rounded(crossings_of_rods * finer * fastest)};
    return modes;
  }
  modes.up_to = Hertz{rounded(crossings * std::sqrt(finer) * fastest)};
  if (!modes.flexibility_error) modes.flexibility_error = std::min(*modes.accuracy, most_flexibility_error);
  return modes;
}

}  // namespace ricochet
