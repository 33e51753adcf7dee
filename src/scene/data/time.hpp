// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include "ricochet/scheme.hpp"

namespace ricochet::scene {

struct Time : Stepping {
  /// The rate of contact steps is not given and follows from the accuracy of the scene: contact_rate_hz where
  /// contact steps have a rate of their own, otherwise rate_hz.
  bool rate_by_accuracy = false;
  bool precision_by_accuracy = false;
  /// rate_hz is not given, and nothing listens at it: where contact needs fewer steps, so many samples do.
  bool samples_by_accuracy = false;
  double duration = 0;  ///< [s]; 0: not given, as equilibrium needs none
  bool operator==(const Time&) const = default;
};

}  // namespace ricochet::scene
