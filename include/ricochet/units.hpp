// SPDX-License-Identifier: BSD-2-Clause
// Frequencies by unit, so that no factor 2π is lost between them.
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
