// SPDX-License-Identifier: BSD-2-Clause
#include "src/store/memory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/memory.hpp"
#include "contact/stepping/step_memory.hpp"
#include "ricochet/error.hpp"
#include "src/scene/elastic_law.hpp"
#include "src/scene/scene.hpp"
#include "src/store/body_warnings.hpp"
#include "src/store/placing.hpp"

namespace ricochet::store {
namespace {

constexpr double usable_share = 0.9;

/// A body yields and turns back within about this many crossings of a wave. In this time, points approach by
/// the undisturbed motion of the bodies.
constexpr double crossings_of_touch = 10;

/// Buffers of the result file and code that a run touches for the first time [bytes].
constexpr double buffers = 7 * base::mib;

/// Coarsened models that estimates keep, in multiples of the model: a third of the points, a ninth of the
/// matrices, and so on.
constexpr double coarser_models = 0.2;

double magnitude(const Vector3& v) { return std::hypot(v[0], v[1], v[2]); }

/// Distance by which two bodies can approach while they touch [m]; infinite if a wave speed is unknown.
double approach_of(const scene::Scene& scene, const KernelPointers& kernels,
                   const contact::ContactPair& pair) {
  double turning = 0, crossing = 0;
  Eigen::Vector3d towards = Eigen::Vector3d::Zero();  // velocity of a relative to b
  for (const int k : {pair.a, pair.b}) {
    if (k < 0) continue;
    const auto body = static_cast<std::size_t>(k);
    const Vector3 size = size_of(*kernels[body]);
    const double length = std::max({size[0], size[1], size[2]});
    const Eigen::Map<const Eigen::Vector3d> velocity(scene.bodies[body].velocity.data());
    towards += (k == pair.a ? 1.0 : -1.0) * velocity;
    turning += magnitude(scene.bodies[body].angular_velocity) * length;
    const double wave = scene::wave_speeds(scene.bodies[body]).low;
    if (!std::isfinite(wave) || length == 0) return std::numeric_limits<double>::infinity();
    crossing = std::max(crossing, length / wave);
  }
  double closing = 0;
  for (const contact::Pairing::Point& point : pair.pairing.points)
    closing = std::max(closing, point.normal.dot(towards));
  const double time = std::min(crossings_of_touch * crossing, scene.time.duration);
  return time * (closing + turning + magnitude(scene.loads.gravity) * scene.time.duration);
}

contact::ModelSize size_of(const scene::Scene& scene, const KernelPointers& kernels,
                           const contact::Placement& placement) {
  contact::ModelSize out{.pairs = 0, .has_residual = true, .turns = scene.motion.is_finite()};
  for (const kernels::Kernel* kernel : kernels) {
    out.modes += static_cast<Eigen::Index>(kernel->modes.size());
    out.has_residual = out.has_residual && kernel->surface.has_flexibility();
  }
  for (const contact::ContactPair& pair : placement.pairs) {
    const auto& points = pair.pairing.points;
    if (points.empty()) continue;
    out.two_sided = out.two_sided || pair.b >= 0;
    const Eigen::Index rows = pair.request.friction ? 3 : 1;
    const double end = std::ranges::min_element(points, {}, &contact::Pairing::Point::gap)->gap +
                       approach_of(scene, kernels, pair);
    ++out.pairs;
    out.points += std::ssize(points);
    out.rows += rows * std::ssize(points);
    out.near += rows * std::ranges::count_if(points, [&](const auto& point) { return point.gap <= end; });
  }
  return out;
}

}  // namespace

void check_memory(const scene::Scene& scene, const std::string& purpose, double needed,
                  const std::string& remedy) {
  const double there = base::available_bytes();
  if (needed > usable_share * there)
    throw InputError(fmt::format("{}: {} need {:.3g} GB of memory, and there are {:.3g}. Set {}.",
                                 scene.file.string(), purpose, needed * 1e-9, there * 1e-9, remedy));
}

double bytes_of(const kernels::Kernel& kernel) {
  const kernels::Surface& surface = kernel.surface;
  double out =
      sizeof(double) * static_cast<double>(surface.shape.size() + surface.residual_flexibility.size());
  if (const auto& compact = surface.compact)
    out += sizeof(float) *
           static_cast<double>(compact->whole.size() + compact->global.size() + compact->near_block.size());
  if (!kernel.view) return out;
  const auto add = [&](const auto& seen) {
    out += sizeof(float) * static_cast<double>(seen.shape.size() + seen.residual_flexibility.size());
  };
  add(*kernel.view);
  if (kernel.view->stress) add(*kernel.view->stress);
  return out;
}

double Need::mib() const { return (now + more) / base::mib; }

Need need_of(const scene::Scene& scene, const KernelPointers& kernels, const contact::Placement& placement) {
  const contact::ModelSize size = size_of(scene, kernels, placement);
  const StepOptions options = step_options(scene);
  const double model = contact::model_bytes(size);
  Need out{.now = base::resident_bytes(), .more = model + buffers};
  if (options.contact.scheme == Scheme::at_rest) {
    // The static flexibility, with and without springs, and the solver; with friction, counted in runs.
    const bool rubs = size.rows > size.points;
    out.more += (rubs ? 6.0 : 3.0) * sizeof(double) * static_cast<double>(size.rows * size.rows);
    return out;
  }
  const double steps =
      contact::stepper_bytes(size, options) * (scene.motion.is_finite() && scene.motion.second_run ? 2 : 1);
  out.more = model + steps + buffers;
  if (!scene.accuracy) return out;
  // Copies of the kernels without their pictures, once for all runs and once with fewer or other modes;
  // models with fewer points; the model of a run, which is built beside these, and its steps.
  double copies = 0;
  for (const kernels::Kernel* kernel : kernels) copies += 2 * bytes_of(*kernel);
  const double choice = copies + (2 + coarser_models) * model + steps;
  out.more = std::max(out.more, choice);
  return out;
}

std::string check_impact(const scene::Scene& scene, const KernelPointers& kernels,
                         const contact::Placement& placement) {
  const Need need = need_of(scene, kernels, placement);
  std::size_t points = 0;
  bool rubs = false;
  for (const contact::ContactPair& pair : placement.pairs) {
    points += pair.pairing.points.size();
    rubs = rubs || pair.request.friction;
  }
  check_memory(scene, fmt::format("{} contact points{}", points, rubs ? " with friction" : ""), need.more,
               "fewer candidates: contact.spacing, contact.reach or contact.zone");
  return fmt::format("{:.0f} MiB needed of {:.0f}", need.mib(),
                     (need.now + base::available_bytes()) / base::mib);
}

}  // namespace ricochet::store
