// SPDX-License-Identifier: BSD-2-Clause
#include "src/impact/report.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "contact/accuracy/error_report.hpp"
#include "contact/figures/stress_peaks.hpp"
#include "src/scene/scene.hpp"

namespace ricochet::impact {
namespace {

std::string seconds(const std::optional<double>& value, const char* otherwise) {
  return value ? fmt::format("{:.6g} s", *value) : otherwise;
}

/// Number of episodes that are listed.
constexpr std::size_t most_episodes = 12;

/// "1: approach 1.1 m/s, restitution 0.92; 2: again while parting at 0.8 m/s": what each episode is.
/// Vibration may bring surfaces together again although the bodies as a whole part; this is no bounce of its
/// own.
std::string episodes_of(const contact::Summary& s) {
  std::string text;
  for (std::size_t k = 0; k < s.episodes.size(); ++k) {
    const auto& [approach, restitution] =
        std::pair(s.episodes[k].approach_m_per_s, s.episodes[k].restitution);
    text += fmt::format("{}{}: ", k == 0 ? "" : "; ", k + 1);
    if (!approach)
      text += "several pairs, or an obstacle that turns";
    else if (*approach <= 0)
      text += fmt::format("again by vibration, while parting at {:.4g} m/s", -*approach);
    else
      text += fmt::format("approach {:.4g} m/s, {}", *approach,
                          restitution ? fmt::format("restitution {:.4g}", *restitution) : "not ended");
  }
  return text;
}

/// "mic 1234 m/s^2 (126 g) at 0.001 s; CFC 60: 12, 180: 34, 600: 56, 1000: 78"
std::string acceleration_of(const std::string& name, const contact::AccelerationPeaks& peaks) {
  constexpr double gravity = 9.80665;
  std::string text = fmt::format("{} {:.4g} m/s^2 ({:.4g} g) at {:.4g} s", name, peaks.peak_m_per_s2,
                                 peaks.peak_m_per_s2 / gravity, peaks.time_s);
  const char* before = "; CFC ";
  for (const auto& [channel_class, peak] : peaks.by_class)
    if (peak) text += fmt::format("{}{}: {:.4g}", std::exchange(before, ", "), channel_class, *peak);
  return text;
}

/// "case 71.2 MPa (von Mises) at gauge foil, 0.001 s, 1.1 of yield"
std::string stress_of(const std::string& body, const contact::StressPeak& peak) {
  return fmt::format("{} {:.4g} MPa (von Mises) at {}, {:.4g} s{}", body, peak.von_mises_pa * 1e-6,
                     contact::place_of(peak), peak.time_s,
                     peak.ratio_to_yield ? fmt::format(", {:.3g} of yield", *peak.ratio_to_yield) : "");
}

}  // namespace

std::string report(const contact::Summary& s, const scene::Scene& scene) {
  std::string text;
  const auto line = [&](const char* name, const std::string& value) {
    text += fmt::format("{:<20}{}\n", name, value);
  };
  std::string modes;
  for (const auto& [name, count] : s.modes) {
    if (name.find('.') != std::string::npos) continue;  // a further strike: no body of a file has a dot
    modes += fmt::format("{}{} {}{}", modes.empty() ? "" : ", ", name, count,
                         s.basis.at(name) == "imported" ? " (imported)" : "");
  }
  if (s.modes_in_residual > 0)
    modes += fmt::format(" ({} above half the rate: quasi-static)", s.modes_in_residual);
  if (!modes.empty()) line("modes", modes);
  if (scene.motion.is_finite())
    line("rotation", "finite" + (scene.motion.reason.empty() ? "" : ": " + scene.motion.reason));
  line("contact points", fmt::format("{}; {} candidates have no opposite surface; at most {} touch at a time",
                                     s.candidates, s.unpaired, s.max_active));
  if (!s.contact_start_s) {
    line("contact", "none");
  } else {
    line("contact starts", seconds(s.contact_start_s, ""));
    line("contact ends", seconds(s.contact_end_s, "still touching"));
    line("episodes", fmt::format("{} ({} steps)", s.episodes.size(), s.contact_steps));
    line("peak force", fmt::format("{:.6g} N", s.peak_force_n));
    line("impulse", fmt::format("{:.6g} N s", s.impulse_ns));
    for (const auto& [name, v] : s.exit_velocity)
      line("exit velocity", fmt::format("{} [{:.6g}, {:.6g}, {:.6g}] m/s", name, v.x(), v.y(), v.z()));
    if (s.restitution)
      line("restitution", fmt::format("{:.6g}{}", *s.restitution,
                                      s.episodes.size() > 1 ? ", from the first touch to the last" : ""));
    if (s.episodes.size() > 1 && s.episodes.size() <= most_episodes) line("each episode", episodes_of(s));
    if (s.energy_lost_contact)
      line("energy to contact", fmt::format("{:.3g} %", 100 * *s.energy_lost_contact));
    if (s.energy_above_band)
      line("above the band", fmt::format("{:.2g} % of the energy{}", 100 * *s.energy_above_band,
                                         s.rebound_above_band ? fmt::format(", {:.2g} of the restitution",
                                                                            *s.rebound_above_band)
                                                              : ""));
    if (s.energy_lost_friction)
      line("energy to friction", fmt::format("{:.3g} %", 100 * *s.energy_lost_friction));
    if (s.friction_impulse_ns) line("friction impulse", fmt::format("{:.6g} N s", *s.friction_impulse_ns));
    if (s.max_slip_m) line("longest slip", fmt::format("{:.6g} m", *s.max_slip_m));
  }
  for (const auto& [name, peaks] : s.acceleration) line("acceleration", acceleration_of(name, peaks));
  for (const auto& [body, peak] : s.stress) line("largest stress", stress_of(body, peak));
  if (s.error_estimate) line("error estimate", contact::formatted(*s.error_estimate));
  if (s.energy_drift) line("energy drift", fmt::format("{:.2g}", *s.energy_drift));
  line("deepest penetration", fmt::format("{:.3g} m", s.max_penetration_m));
  for (const auto& [name, sound] : s.sounds)
    line("sound", fmt::format("{}, full scale {:.3g} m/s", sound.file, sound.full_scale_m_per_s));
  if (s.sound)
    line("sound", fmt::format("{}, full scale {:.3g} m/s", s.sound->file, s.sound->full_scale_m_per_s));
  if (s.limited_steps > 0)
    line("limited steps",
         fmt::format("{} by max_pivots, residual up to {:.2g}", s.limited_steps, s.limited_residual));
  line("speed", fmt::format("{:.3g} x real time", s.real_time_factor));
  return text;
}

std::string report(const contact::EquilibriumSummary& s, const scene::Scene& scene) {
  std::string text;
  for (std::size_t p = 0; p < s.pairs.size(); ++p) {
    const auto& pair = s.pairs[p];
    text += fmt::format("{} on {}: ", scene.contact.pairs[p].a, scene.contact.pairs[p].b);
    text += pair.contact_points == 0
                ? "no contact\n"
                : fmt::format("{:.6g} N on {} points, {:.4g} m^2, at most {:.4g} Pa; approach {:.6g} m\n",
                              pair.force_n, pair.contact_points, pair.contact_area_m2, pair.peak_pressure_pa,
                              pair.approach_m);
    if (pair.friction_n)
      text += fmt::format("  friction {:.6g} N, {} points stick, {} slip\n", *pair.friction_n,
                          *pair.sticking_points, *pair.slipping_points);
  }
  for (const auto& [body, peak] : s.stress)
    text += fmt::format("largest stress      {}\n", stress_of(body, peak));
  if (s.error_estimate)
    text += fmt::format("error estimate      {}\n", contact::formatted(*s.error_estimate));
  return text + fmt::format("imbalance           {:.2g}\ndeepest penetration {:.3g} m\n", s.imbalance,
                            s.max_penetration_m);
}

}  // namespace ricochet::impact
