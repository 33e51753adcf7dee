// SPDX-License-Identifier: BSD-2-Clause
// The quantities of interest: the results by which runs of one scene are compared, and whose errors are
// estimated.
#pragma once

#include <array>
#include <string_view>

namespace ricochet {

enum class Quantity {
  impulse,     ///< Σ λ_i Δ over the run
  rebound,     ///< mean velocities of the bodies that can move rigidly, when contact last ended
  spin,        ///< their angular velocities at that time
  peak_force,  ///< largest Σ λ_i of a step
  duration,    ///< time with contact
  energy,      ///< energy that became vibration, and energy that contact and damping removed
  receivers,   ///< velocities of the receivers, as magnitudes in bands of a third of an octave
  force,       ///< at rest: force of each pair
  approach,    ///< at rest: approach of each pair
};

/// The names in scenes and summaries, in the order of the enumeration.
inline constexpr std::array<std::string_view, 9> quantity_names{
    "impulse", "rebound", "spin", "peak_force", "duration", "energy", "receivers", "force", "approach"};

inline std::string_view name_of(Quantity quantity) {
  return quantity_names[static_cast<std::size_t>(quantity)];
}

}  // namespace ricochet
