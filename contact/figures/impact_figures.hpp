// SPDX-License-Identifier: BSD-2-Clause
// The figures of an impact. Summaries, error estimates, studies and benchmarks take them from here.
//
// λ_k acts over (t_{k−1}, t_k]: contact starts at the beginning of the first step with a force and ends at
// the end of the last one. An episode is an uninterrupted sequence of steps with a force.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "contact/figures/figure.hpp"

namespace ricochet::contact {

struct Episode {
  double start_s = 0;
  std::optional<double> end_s;  ///< no value if bodies touch in the last step of the run
  double impulse_ns = 0;        ///< Σ λ_i Δ
  double peak_force_n = 0;      ///< largest Σ_i λ_i of a step
  /// Closing speed along the impulse of the episode when it began, of bodies as a whole [m/s], relative to
  /// the velocity of an obstacle at the mean place of this impulse. No value if more than one pair touched.
  std::optional<double> approach_m_per_s{};
  /// Minus the ratio of exit to approach; no value without an end or an approach.
  std::optional<double> restitution{};
};

/// An uninterrupted sequence of steps in which a pair has a force.
struct Touch {
  double start_s = 0;
  std::optional<double> end_s;       ///< no value if the pair touches in the last step of the run
  std::string a{}, b{};              ///< bodies, or a body and an obstacle
  Eigen::Vector3d impulse{0, 0, 0};  ///< Σ λ n Δ on b [N s], without friction
};

struct ImpactFigures {
  std::optional<double> contact_start_s;
  std::optional<double> contact_end_s;  ///< no value without contact, or if bodies touch in the last step
  std::int64_t contact_steps = 0;       ///< steps with a force
  std::vector<Episode> episodes;
  std::vector<Touch> touches;  ///< of all pairs, by their start
  double peak_force_n = 0;     ///< largest Σ_i λ_i of a step
  double impulse_ns = 0;       ///< Σ λ_i Δ over the run
  int max_active = 0;          ///< largest number of points that touched at once
  /// Mass-mean velocity of each body when contact last ended [m/s]; empty if contact_end_s has no value.
  std::map<std::string, Eigen::Vector3d> exit_velocity;
  /// Minus the ratio of exit to approach relative velocity along the impulse, as for episodes. No value if
  /// contact has no end, if there is no approach, or if more than one pair touched.
  std::optional<double> restitution;
  double max_penetration_m = 0;  ///< largest u − g at the end of a step
  Figures quantities;            ///< without those of receivers
};

}  // namespace ricochet::contact
