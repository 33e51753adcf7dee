// SPDX-License-Identifier: BSD-2-Clause
// Piecewise linear factors of loads and moving supports.
#pragma once

#include <cstddef>
#include <vector>

namespace ricochet::contact {

/// h(t) is 0 before the first knot, linear between knots, and constant after the last one. It may jump at the
/// first knot; h and its slope are those just after t. The default is 1 from t = 0 on.
struct History {
  std::vector<double> time{0.0};   ///< of the knots, ascending [s]
  std::vector<double> value{1.0};  ///< at the knots

  double at(double t) const noexcept;
  double slope(double t) const noexcept;  ///< [1/s]
  /// ∫ h dt
  double integral(double from, double to) const noexcept;
  /// ∫ (to − t) h dt: what a mass of 1 that is at rest moves by
  double double_integral(double from, double to) const noexcept;
  double peak(double from, double to) const noexcept;      ///< largest |h| within an interval
  double steepest(double from, double to) const noexcept;  ///< largest |slope| within it [1/s]

  /// Whether h began before t = 0 and is constant from then on, as that of a dead load.
  bool dead() const noexcept;

  /// Number of knots at or before t, which is the index of the first knot after t.
  std::size_t passed(double t) const noexcept;
  /// Changes of h and of its slope at a knot.
  double jump(std::size_t knot) const noexcept { return knot == 0 ? value[0] : 0; }
  double kink(std::size_t knot) const noexcept {
    return slope_after(knot) - (knot == 0 ? 0 : slope_after(knot - 1));
  }

 private:
  double slope_after(std::size_t knot) const noexcept;
};

/// Of a load that has always acted.
inline const History dead_load{{-1.0}, {1.0}};

}  // namespace ricochet::contact
