// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include "ricochet/scheme.hpp"

namespace ricochet::scene {

/// In place of the duration, of a run that ends when bodies have parted.
inline constexpr const char* duration_until_parted = "until parted";
/// The default of time.longest [s]: most impacts last milliseconds, and a fall from 1 m half of this.
inline constexpr double default_longest = 1;

struct Time : Stepping {
  /// The rate of contact steps is not given and follows from the accuracy of the scene: contact_rate_hz where
  /// contact steps have a rate of their own, otherwise rate_hz.
  bool rate_by_accuracy = false;
  bool precision_by_accuracy = false;
  /// rate_hz is not given, and nothing listens at it: where contact needs fewer steps, so many samples do.
  bool samples_by_accuracy = false;
  /// [s]; of a run that ends when bodies have parted: at most. 0: not given, as equilibrium needs none.
  double duration = 0;
  bool until_parted = false;  ///< whether the run ends when bodies have parted
  /// The key that gives `duration`.
  const char* key_of_duration() const { return until_parted ? "time.longest" : "time.duration"; }
  bool operator==(const Time&) const = default;
};

}  // namespace ricochet::scene
