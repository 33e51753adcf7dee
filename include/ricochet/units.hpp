// SPDX-License-Identifier: BSD-2-Clause
// One type for each unit of frequency, so that no factor 2π is forgotten.
#pragma once

#include <array>
#include <numbers>

namespace ricochet {

using Vector3 = std::array<double, 3>;

struct RadPerSecond {
  double value = 0;
};

struct Hertz {
  double value = 0;
  constexpr explicit operator RadPerSecond() const { return {2 * std::numbers::pi * value}; }
  bool operator==(const Hertz&) const = default;
};

constexpr Hertz to_hertz(RadPerSecond omega) { return {omega.value / (2 * std::numbers::pi)}; }

}  // namespace ricochet
