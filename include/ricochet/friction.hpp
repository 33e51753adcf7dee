// SPDX-License-Identifier: BSD-2-Clause
#pragma once

namespace ricochet {

/// Coulomb friction of a contact pair. With the sliding speed v of a point,
/// μ(v) = μ_d + (μ_s − μ_d) exp(−(v/v_s)²), Stribeck's transition from sticking to sliding.
struct Friction {
  double static_coefficient = 0;   ///< μ_s ≥ 0, of points that stick
  double dynamic_coefficient = 0;  ///< μ_d ≥ 0, of points that slide fast
  double stribeck_velocity = 0;    ///< v_s > 0 [m/s]; unused if the coefficients are equal
  bool operator==(const Friction&) const = default;
};

}  // namespace ricochet
