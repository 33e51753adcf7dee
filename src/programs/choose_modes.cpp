#include "src/programs/choose_modes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "src/mesh/gmsh_session.hpp"
#include "src/mesh/open.hpp"
#include "src/parallel/parallel.hpp"
#include "src/scene/parts.hpp"

namespace ricochet {
namespace {

/// Waves that cross the body one after the other within the shortest period of the band, the more the more accurate
/// results are to be: 2 at 1e-2, as the square root.
constexpr double crossings = 2, reference = 1e-2;

/// What accuracy needs of the flexibility: impacts feel a few times less than the error of it.
constexpr double most_flexibility_error = 0.1;

double crossing_rate(const scene::Scene& scene, const scene::Body& body) {
  scene::Body opened = body;
  if (const auto parts = scene::part_files(body.mesh); !parts.empty()) opened.mesh = parts.front();
  const mesh::GmshSession gmsh(geometry_numbers(body));
  double length = 0, speed = 0;
  mesh::with_gmsh_errors(body.mesh.filename().string(), [&] { length = mesh::length_of(opened); });
  for (const scene::Material& material : body.materials)
    speed = std::max(speed, std::sqrt(material.young / material.density));
  if (!(length > 0))
    throw InputError(fmt::format("{}: bodies.{}: no size is found in {}, so accuracy can't choose modes: give "
                                 "modes.up_to_hz or modes.count",
                                 scene.file.string(), body.name, body.mesh.filename().string()));
  return speed / length;
}

/// Two digits: a band that round-off does not change.
double rounded(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1);
  return std::ceil(value / unit - 1e-9) * unit;
}

}  // namespace

std::vector<std::string> geometry_numbers(const scene::Body& body) {
  std::vector<std::string> numbers;
  for (const auto& [name, value] : body.geometry) {
    numbers.push_back(name);
    numbers.push_back(fmt::format("{}", value));
  }
  return numbers;
}

scene::Modes chosen_modes(const scene::Scene& scene, MPI_Comm comm) {
  std::vector<double> fastest{0.0};
  parallel::on_first_rank(comm, [&] {
    for (const scene::Body& body : scene.bodies) fastest[0] = std::max(fastest[0], crossing_rate(scene, body));
  });
  parallel::broadcast(comm, fastest);
  scene::Modes modes = scene.modes;
  const double accuracy = *modes.accuracy;
  modes.up_to = Hertz{rounded(crossings * std::max(1.0, std::sqrt(reference / accuracy)) * fastest[0])};
  if (!modes.flexibility_error) modes.flexibility_error = std::min(accuracy, most_flexibility_error);
  return modes;
}

}  // namespace ricochet
