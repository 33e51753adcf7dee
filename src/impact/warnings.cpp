// SPDX-License-Identifier: BSD-2-Clause
#include "src/impact/warnings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <string>

#include "src/impact/parting.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::impact {
namespace {

/// Number of steps below which an episode is too coarse. The bell of meshes/bell rebounds too slowly by 12 %
/// with 16 steps and by 5 % with 32.
constexpr double few_steps = 20;

/// Share of the energy that contact may remove. A frictionless contact of elastic bodies removes none.
constexpr double lost_share = 0.01;

/// Share of the indentation that a surface may be off its drawing at worst. Only what it deviates within the
/// zone of contact matters: for two balls of 10 mm, of which one was off by 32 % (69 %), the peak force
/// changed by 2.0 % (0.3 %) with linear and by 0.06 % (1.5 %) with finite rotations.
constexpr double rough_share = 0.25;

/// A coefficient of restitution from 0 to 1 may leave this interval by the accuracy that is requested by
/// default, and by what gravity adds to the speeds during a touch.
constexpr double slack_of_restitution = 0.01;

std::string too_few_steps(const scene::Scene& scene, const contact::Summary& summary) {
  if (scene.accuracy) return "";
  double longest = 0;
  for (const contact::Episode& episode : summary.episodes) {
    if (!episode.end_s) return "";
    longest = std::max(longest, (*episode.end_s - episode.start_s) / scene.time.step());
  }
  if (!(longest > 0 && longest < few_steps - 0.5)) return "";
  return fmt::format(
      "the longest touch has {:.0f} steps: peak force, rebound and the energy that contact takes depend on "
      "the time step. Raise time.rate_hz, or set accuracy",
      longest);
}

std::string lost_energy(const scene::Scene& scene, const contact::Summary& summary) {
  const double most = std::max(lost_share, scene.accuracy.value_or(0));
  if (!(summary.energy_lost_contact.value_or(0) > most)) return "";
  return fmt::format(
      "contact removed {:.3g} % of the energy (above {:g} %), which elastic bodies {}: "
      "rebound and vibration are too weak. {}",
      100 * *summary.energy_lost_contact, 100 * most,
      summary.energy_lost_friction ? "keep but for the heat of friction" : "without friction keep",
      scene.modes.residual_flexibility
          ? scene.accuracy ? "Raise time.rate_hz, or leave it out" : "Raise time.rate_hz, or set accuracy"
          : "Set modes.residual_flexibility = true, or raise the number of modes and time.rate_hz");
}

std::string impossible_restitution(const contact::Summary& summary) {
  if (!summary.restitution) return "";
  const double e = *summary.restitution;
  if (e >= -slack_of_restitution && e <= 1 + slack_of_restitution) return "";
  return fmt::format(
      "restitution {:.4g} is {}: {}", e, e < 0 ? "below 0" : "above 1",
      e < 0
          ? "the bodies as a whole still approach each other when contact last ends. A corner may leave "
            "while the centre of a body that turns goes on; otherwise, parts without candidates pass through "
            "each other. See the motion, and whether contact names all surfaces that meet"
          : "loads, moving supports, rotation or vibration before contact fed the rebound, so it is not a "
            "property of the impact");
}

std::string several_solutions(const contact::Summary& summary) {
  const std::int64_t steps = summary.ambiguous_steps.value_or(0);
  if (steps == 0) return "";
  return fmt::format(
      "{} of {} contact steps had more than one solution (friction too large for this contact, Painlevé): "
      "their forces are one of several. Lower contact.friction",
      steps, summary.contact_steps);
}

std::string separated(const contact::Summary& summary) {
  if (!summary.separation_s) return "";
  const auto before = std::ranges::count_if(
      summary.touches, [&](const contact::Touch& touch) { return touch.start_s < *summary.separation_s; });
  return fmt::format(
      "a second run, with speeds larger by half a per cent and another step, moves otherwise from t = {:.4g} "
      "s "
      "on, after {} of {} touches: what follows is one of many motions. Rely on the earlier touches",
      *summary.separation_s, before, summary.touches.size());
}

/// The largest indentation of an obstacle by touches that were the only ones at their time [m], from the
/// speed of approach v and the duration T of each: v T/π of a spring, and v T/2.94 of a Hertzian contact.
double indentation_of(const scene::Obstacle& obstacle, const contact::Summary& summary) {
  double deepest = 0;
  for (const contact::Episode& episode : summary.episodes) {
    const bool is_of = std::ranges::any_of(summary.touches, [&](const contact::Touch& touch) {
      return touch.b == obstacle.name && touch.start_s == episode.start_s;
    });
    if (is_of && episode.approach_m_per_s && episode.end_s)
      deepest = std::max(deepest,
                         *episode.approach_m_per_s * (*episode.end_s - episode.start_s) / std::numbers::pi);
  }
  return deepest;
}

std::string rough_surface(const scene::Obstacle& obstacle, const contact::Summary& summary) {
  const double indentation = indentation_of(obstacle, summary);
  if (!(indentation > 0 && obstacle.deviation > rough_share * indentation)) return "";
  return fmt::format(
      "the triangles of obstacles.{} are up to {:.2g} m from its drawing, {:.2g} % of the indentation of "
      "about "
      "{:.2g} m: forces follow the triangles. Lower obstacles.{}.size_factor",
      obstacle.name, obstacle.deviation, 100 * obstacle.deviation / indentation, indentation, obstacle.name);
}

}  // namespace

std::vector<std::string> motions_without_friction(const scene::Scene& scene) {
  std::vector<std::string> out;
  for (const scene::Obstacle& obstacle : scene.obstacles) {
    const bool driven = std::ranges::count(scene.loads.motions, obstacle.name, &scene::Forcing::obstacle) > 0;
    if (!scene::moves(scene, obstacle) || scene::leaves_its_surface(scene, obstacle) ||
        scene.contact.rubs(obstacle.name))
      continue;
    out.push_back(
        fmt::format("obstacles.{} moves along its surface, which has no effect without friction: give "
                    "contact.friction, or "
                    "leave {} out",
                    obstacle.name, driven ? "its motion" : "velocity"));
  }
  return out;
}

void add_warnings(const scene::Scene& scene, contact::Summary& summary) {
  const auto add = [&](std::string warning) {
    if (!warning.empty()) summary.warnings.push_back(std::move(warning));
  };
  // The impulse scheme removes energy by definition, by its coefficient of restitution.
  if (scene.contact.scheme == Scheme::compliant && scene.contact.kernel == scene::ContactKernel::modes) {
    add(too_few_steps(scene, summary));
    add(lost_energy(scene, summary));
    add(several_solutions(summary));
    add(separated(summary));
  }
  add(impossible_restitution(summary));
  for (const scene::Obstacle& obstacle : scene.obstacles) add(rough_surface(obstacle, summary));
  add(ends_in_contact(scene, summary));
}

}  // namespace ricochet::impact
