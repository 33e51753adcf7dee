// SPDX-License-Identifier: BSD-2-Clause
// Laws of damping that do not couple the modes.
#pragma once

#include <array>
#include <vector>

namespace ricochet::kernels {

struct Damping {
  enum class Law { none, ratio, loss_factor, rayleigh, viscosity, t60, by_mode };
  Law law = Law::none;
  double first = 0;   ///< ζ | η | α [1/s] | η [s]
  double second = 0;  ///< rayleigh: β [s]
  /// t60: rows of frequency [Hz], ascending, and time of a decay by 60 dB [s]; all above 0
  std::vector<std::array<double, 2>> table{};
  std::vector<double> by_mode{};  ///< by_mode: η of the elastic modes, from the lowest on
  bool operator==(const Damping&) const = default;
};

/// Decay rates δ = ζω [1/s] of all modes of a body.
/// @param omega  (N) angular frequencies [rad/s], ascending; rigid modes first, exactly 0
std::vector<double> decay_rates(const Damping& damping, const std::vector<double>& omega);

}  // namespace ricochet::kernels
