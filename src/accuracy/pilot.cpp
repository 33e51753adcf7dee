// SPDX-License-Identifier: BSD-2-Clause
#include "src/accuracy/pilot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/accuracy/contact_zone.hpp"
#include "src/accuracy/decision.hpp"
#include "src/accuracy/mesh_levels.hpp"
#include "src/mesh/apart.hpp"
#include "src/mesh/gmsh_session.hpp"
#include "src/parallel/parallel.hpp"
#include "src/scene/elastic_law.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::accuracy {
namespace {

/// Flexibility error of Ritz vectors.
constexpr double coarse_flexibility_error = 0.1;

/// Crossings of the body in the shortest period of the band.
constexpr double crossings = 2, crossings_of_rods = 8;

struct Waves {
  double rate;  ///< crossings of the body per second
  bool rod;
};

Waves waves(const scene::Scene& scene, const scene::Body& body) {
  scene::Body opened = body;
  if (!body.converted.empty()) opened.mesh = body.converted;
  const mesh::GmshSession gmsh;
  const mesh::Extent extent = mesh::extent_apart(opened);
  const double speed = scene::wave_speeds(body).mean;
  if (!(extent.length > 0))
    throw InputError(
        fmt::format("{}: bodies.{}: {} has no extent, so accuracy cannot choose modes: give "
                    "modes.up_to_hz or modes.count",
                    scene.file.string(), body.name, body.mesh.filename().string()));
  return {speed / extent.length, extent.dimension == 1};
}

/// Rounds up to two significant digits, so that round-off does not change the band.
double rounded(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1);
  return std::ceil(value / unit - 1e-9) * unit;
}

Hertz coarse_band(const scene::Scene& scene, MPI_Comm comm) {
  double rate = std::numeric_limits<double>::infinity();
  parallel::on_first_rank(comm, [&] {
    bool rods = true;
    for (const scene::Body& body : scene.bodies) {
      const Waves of_body = waves(scene, body);
      rate = std::min(rate, of_body.rate);
      rods = rods && of_body.rod;
    }
    rate = rounded((rods ? crossings_of_rods : crossings) * rate);
  });
  return Hertz{parallel::of_rank(comm, 0, rate)};
}

}  // namespace

Settings pilot_settings(const scene::Scene& scene, MPI_Comm comm) {
  Settings out;
  out.pilot = true;
  out.found.mesh = meshes_at(scene, 0);
  out.found.flexibility_error = coarse_flexibility_error;
  out.found.zone = within_flight(scene);
  out.found.view = !has_finer(scene, out.found.mesh);  // otherwise, nobody looks at its kernels
  out.found.rotation = scene.motion.rotation;
  if (scene.modes.open()) {
    // Without a spacing, whole surfaces are candidates, and then modes are cheaper than Ritz vectors.
    const bool few = gives_spacing(scene) && !scene.motion.is_finite();
    out.found.basis = few ? scene::Basis::contact : scene::Basis::modes;
    out.found.up_to = coarse_band(scene, comm);
  } else {
    out.found.basis = scene.modes.basis;
    out.found.up_to = scene.modes.up_to.value_or(Hertz{1});
  }
  return out;
}

}  // namespace ricochet::accuracy
