// SPDX-License-Identifier: BSD-2-Clause
// Laws of damping that do not couple the modes.
#pragma once

#include "ricochet/units.hpp"

namespace ricochet::kernels {

struct Damping {
  enum class Law { none, ratio, loss_factor, rayleigh, viscosity };
  Law law = Law::none;
  double first = 0;   ///< ζ | η | α [1/s] | η [s]
  double second = 0;  ///< rayleigh: β [s]
  bool operator==(const Damping&) const = default;
};

/// Decay rate δ = ζω [1/s] of a mode with angular frequency ω.
double decay_rate(const Damping& damping, RadPerSecond omega);

}  // namespace ricochet::kernels
