// SPDX-License-Identifier: BSD-2-Clause
#include "src/store/body_warnings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace ricochet::store {
namespace {

// A body of 20 m, or one of 2 m from a CAD file, which usually is in millimetres; a body of 10 um.
constexpr double longest = 20, longest_in_cad = 2, shortest = 1e-5;
constexpr double inch = 0.0254;  // m
// A grain of 10 um of quartz weighs 1e-12 kg; 1e6 kg is a cube of steel of 5 m.
constexpr double lightest = 1e-12, heaviest = 1e6;
// √(E/ρ) is 1 m/s in the softest gels and 18 km/s in diamond. No solid of the density of stone or metal is as
// soft as 10 m/s; lead has 1200 m/s.
constexpr double slowest = 1, slowest_of_dense = 10, dense = 2500, fastest = 3e4;
/// Poisson's ratio above which linear elements lock. They can hardly deform at constant volume, and peak
/// forces become at least twice as large.
constexpr double locking_poisson = 0.45;
/// Error of a displacement due to compression of the residual flexibility above which a warning is due.
constexpr double most_compression_error = 0.01;

bool is_cad(const scene::Body& body) {
  return body.mesh.extension() == ".step" || body.mesh.extension() == ".brep";
}

void add_implausible(const scene::Body& body, const kernels::Kernel& kernel, std::vector<std::string>& out) {
  const Vector3 size = size_of(kernel);
  const double length = std::max({size[0], size[1], size[2]});
  const bool unscaled = is_cad(body) && body.scale == 1;
  if (length > (unscaled ? longest_in_cad : longest) || (length > 0 && length < shortest))
    out.push_back(fmt::format("{} is {:.4g} m long: check bodies.{}.scale{}", body.name, length, body.name,
                              length > 1 ? " (0.001 for a mesh in millimetres)" : ""));
  // A factor from inches, though gmsh converts the unit of a STEP file to millimetres.
  if (body.mesh.extension() == ".step" && std::abs(body.scale / inch - 1) < 0.01)
    out.push_back(
        fmt::format("{0} is {1:.4g} m long with bodies.{0}.scale = {2:g}: a STEP file is read in "
                    "millimetres, whatever its unit: set scale = 0.001",
                    body.name, length, body.scale));
  if (kernel.mass > heaviest || kernel.mass < lightest)
    out.push_back(fmt::format("{} has a mass of {:.4g} kg: check its density, in kg/m³, and its scale",
                              body.name, kernel.mass));
  for (const scene::Material& material : body.materials) {
    const scene::WaveSpeeds waves = scene::wave_speeds(material);
    const bool slow = waves.low < (material.density >= dense ? slowest_of_dense : slowest);
    if (!slow && !(waves.high > fastest)) continue;
    const double speed = slow ? waves.low : waves.high;
    out.push_back(fmt::format(
        "waves in {} run at {:.4g} m/s (young = {:.4g} Pa, density = {:.4g} kg/m³), {} than in any usual "
        "solid: check the units of young (Pa) and density (kg/m³)",
        body.name, speed, speed * speed * material.density, material.density, slow ? "slower" : "faster"));
  }
}

void add_locking(const scene::Body& body, const kernels::Kernel& kernel, std::vector<std::string>& out) {
  for (const scene::Material& material : body.materials) {
    const double poisson = scene::mean_poisson(material);
    if (kernel.order == 1 && material.area == 0 && poisson > locking_poisson)  // a rod has an area
      out.push_back(
          fmt::format("{}: elements of order 1 lock at {} {:g} (above {:g}), forces are far too large: "
                      "use order 2 or more",
                      body.name, material.isotropic() ? "poisson =" : "a mean Poisson's ratio of", poisson,
                      locking_poisson));
  }
}

/// The number of elements and the place of each piece, or of the first of many; empty if not known.
std::string pieces_of(const kernels::Kernel& kernel) {
  constexpr std::size_t most = 4;
  const std::size_t pieces = kernel.piece_elements.size(), named = pieces > most + 1 ? most : pieces;
  std::vector<std::string> out;
  for (std::size_t p = 0; p < named; ++p) {
    const double* box = &kernel.piece_box[6 * p];
    out.push_back(fmt::format("{} element{} in x {:.4g} to {:.4g}, y {:.4g} to {:.4g}, z {:.4g} to {:.4g} m",
                              kernel.piece_elements[p], kernel.piece_elements[p] == 1 ? "" : "s", box[0],
                              box[3], box[1], box[4], box[2], box[5]));
  }
  if (named < pieces) out.push_back(fmt::format("{} more", pieces - named));
  return out.empty() ? "" : fmt::format(" ({})", fmt::join(out, "; "));
}

/// Parts that move through each other, or that hinge on each other.
void add_loose(const scene::Body& body, const kernels::Kernel& kernel, std::vector<std::string>& out) {
  // A connected body has six rigid modes, a rod one. Kernels of other programs do not state their parts.
  const auto rigid = std::ranges::count(kernel.modes.angular_frequency, 0.0);
  // The key `area` has no effect on solids, and one patch has no more corners than the end of a rod.
  const bool rod =
      kernel.surface.corners() == 1 && !body.materials.empty() && body.materials.front().area > 0;
  const int most = rod ? 1 : 6;
  const std::string modes = fmt::format("{} rigid mode{}", rigid, rigid == 1 ? "" : "s");
  const auto pieces = std::ssize(kernel.piece_elements);
  if (kernel.parts == 1 && pieces > 1)
    out.push_back(
        fmt::format("{} consists of {} pieces that are joined at edges or points only, with {} in "
                    "all: they turn about these joints without resistance, and move through each other{}. "
                    "Join them at faces, or leave all but one out",
                    body.name, pieces, modes, pieces_of(kernel)));
  else if (kernel.parts > 1 || rigid > most)
    out.push_back(fmt::format(
        "{} consists of {} that are not joined{}, with {} in all: they move through each "
        "other{}. "
        "Give them common nodes (gmsh: Coherence, BooleanFragments)",
        body.name, kernel.parts > 1 ? fmt::format("{} parts", kernel.parts) : "parts",
        pieces > kernel.parts
            ? fmt::format(", of {} pieces of which some are joined at edges or points only", pieces)
            : "",
        modes, pieces_of(kernel)));
}

}  // namespace

Vector3 size_of(const kernels::Kernel& kernel) {
  Vector3 low{}, high{};
  for (std::size_t i = 0; i < kernel.outline.size(); ++i) {
    const double x = kernel.outline[i];
    low[i % 3] = i < 3 ? x : std::min(low[i % 3], x);
    high[i % 3] = i < 3 ? x : std::max(high[i % 3], x);
  }
  return {high[0] - low[0], high[1] - low[1], high[2] - low[2]};
}

std::string figures_of(const scene::Body& body, const kernels::Kernel& kernel) {
  const Vector3 size = size_of(kernel);
  std::string text =
      fmt::format("mass {:.4g} kg, size {:.4g} x {:.4g} x {:.4g} m", kernel.mass, size[0], size[1], size[2]);
  const auto [low, high, mean] = scene::wave_speeds(body);
  if (high > low)
    text += fmt::format(", wave speed {:.4g} to {:.4g} m/s", low, high);
  else if (high > 0)
    text += fmt::format(", wave speed {:.4g} m/s", high);
  if (const auto& compact = kernel.surface.compact; compact && compact->compressed())
    text += fmt::format(", residual flexibility of {} candidates compressed within {:.2g} %",
                        kernel.surface.size(), 100 * compact->error);
  return text;
}

std::vector<std::string> warnings_of(const scene::Body& body, const kernels::Kernel& kernel) {
  std::vector<std::string> out;
  add_implausible(body, kernel, out);
  add_loose(body, kernel, out);
  if (kernel.held_on_lines != 0) {
    std::string components;
    for (int c = 0; c < 3; ++c)
      if ((kernel.held_on_lines >> c & 1) != 0) components += "xyz"[c];
    out.push_back(fmt::format(
        "the supports of {} hold {} on lines or points only: the displacement under them has no limit as the "
        "mesh is refined. Hold a surface",
        body.name, fmt::join(components, ", ")));
  }
  add_locking(body, kernel, out);
  if (const auto& compact = kernel.surface.compact; compact && compact->error > most_compression_error)
    out.push_back(fmt::format(
        "{}: compressing the residual flexibility of its {} candidates causes an error of {:.2g} % (above "
        "{:g} "
        "%) of the displacement under a force. Name fewer surfaces in contact, or use a coarser mesh",
        body.name, kernel.surface.size(), 100 * compact->error, 100 * most_compression_error));
  return out;
}

}  // namespace ricochet::store
