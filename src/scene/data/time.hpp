// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <optional>

#include "ricochet/scheme.hpp"
#include "ricochet/units.hpp"

namespace ricochet::scene {

/// Largest number of contact steps per output sample.
inline constexpr double most_steps_per_sample = 1e6;

struct Time {
  Hertz rate{44100};  ///< of the output samples
  std::optional<Hertz>
      contact_rate{};  ///< of contact steps, rounded up to a multiple of `rate`; no value: `rate`
  /// The rate of contact steps is not given and follows from the accuracy of the scene: contact_rate where
  /// contact steps have a rate of their own, otherwise `rate`.
  bool rate_by_accuracy = false;
  int steps_per_sample() const;
  double step() const { return 1 / (rate.value * steps_per_sample()); }  ///< of contact, Δ [s]
  /// Precision of the matrix products of the steps (scheme "compliant"); no value: chosen by the accuracy of
  /// the scene.
  std::optional<Precision> precision = Precision::float64;
  double duration = 0;  ///< [s]; 0: not given, as equilibrium needs none
  bool operator==(const Time&) const = default;
};

}  // namespace ricochet::scene
