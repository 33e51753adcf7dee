// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/stress_measures.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ricochet::contact {

double von_mises(const double* s) noexcept {
  const double xy = s[0] - s[1], yz = s[1] - s[2], zx = s[2] - s[0];
  return std::sqrt((xy * xy + yz * yz + zx * zx) / 2 + 3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

double frobenius(const double* s) noexcept {
  return std::sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2] + 2 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

Principal principal(const double* s) noexcept {
  const double p = mean_stress(s), equivalent = von_mises(s);
  if (!(equivalent > 0)) return {p, p};
  const double x = (s[0] - p) / equivalent, y = (s[1] - p) / equivalent, z = (s[2] - p) / equivalent,
               yz = s[3] / equivalent, xz = s[4] / equivalent, xy = s[5] / equivalent;
  const double det = x * (y * z - yz * yz) - xy * (xy * z - yz * xz) + xz * (xy * yz - y * xz);
  const double angle = std::acos(std::clamp(13.5 * det, -1.0, 1.0)) / 3, radius = equivalent * 2 / 3;
  return {p + radius * std::cos(angle), p + radius * std::cos(angle + 2 * std::numbers::pi / 3)};
}

}  // namespace ricochet::contact
