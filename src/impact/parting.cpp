// SPDX-License-Identifier: BSD-2-Clause
#include "src/impact/parting.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace ricochet::impact {
namespace {

constexpr std::int64_t longer = 20, enough_steps = 20'000;

bool is_pressed(const scene::Scene& scene) {
  const scene::Loads& loads = scene.loads;
  return loads.gravity != Vector3{} || !loads.tractions.empty() || !loads.points.empty() ||
         !loads.motions.empty();
}

/// Two digits, rounded up.
double rounded_up(double value) {
  const double unit = std::pow(10, std::floor(std::log10(value)) - 1);
  return std::ceil(value / unit) * unit;
}

}  // namespace

std::optional<double> parting(const Impact& impact, contact::Stepper& stepper,
                              contact::FigureObserver figures) {
  // Sampled responses end with the run, and bodies that turn under loads come to rest on others.
  if (impact.table || (impact.scene.motion.is_finite() && is_pressed(impact.scene))) return std::nullopt;
  const std::int64_t most = is_pressed(impact.scene)
                                ? std::min(impact.steps, enough_steps)
                                : std::min(longer * impact.steps, std::max(impact.steps, enough_steps));
  const std::int64_t end = stepper.steps() + most;
  while (stepper.steps() < end && stepper.step() == StepStatus::ok) {
    figures.observe(stepper);
    if (figures.parted(stepper)) return stepper.time();
  }
  return std::nullopt;
}

std::string ends_in_contact(const scene::Scene& scene, const contact::Summary& summary) {
  if (!summary.contact_start_s || summary.contact_end_s) return "";
  constexpr const char* what =
      "the bodies still touch at the end, so there is no restitution and no exit velocity: {}";
  const char* key = scene.time.key_of_duration();
  if (summary.parted_s)
    return fmt::format(fmt::runtime(what),
                       fmt::format("they have parted at t = {:.4g} s. Set {} = {:.2g}", *summary.parted_s,
                                   key, rounded_up(*summary.parted_s)));
  if (scene.contact.kernel == scene::ContactKernel::table) return "";
  if (!is_pressed(scene))
    return fmt::format(fmt::runtime(what),
                       fmt::format("they do not part soon afterwards. Set a longer {}", key));
  if (!scene.time.until_parted) return "";
  return fmt::format(fmt::runtime(what),
                     fmt::format("loads may press them together for good, and they have not parted until "
                                 "time.longest = {:g} s. Give time.duration in seconds",
                                 scene.time.duration));
}

}  // namespace ricochet::impact
