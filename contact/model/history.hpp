// SPDX-License-Identifier: BSD-2-Clause
// Factors that vary in time, piecewise linear: of loads, and of supports that move.
#pragma once

#include <cstddef>
#include <vector>

namespace ricochet::contact {

/// h(t): 0 before the first knot, linear between knots, the last value after the last one. It may jump at the
/// first knot; h and its slope are those just after t. By default 1 from t = 0 on.
struct History {
  std::vector<double> time{0.0};   ///< of the knots, ascending [s]
  std::vector<double> value{1.0};  ///< at the knots, as many

  double at(double t) const noexcept;
  double slope(double t) const noexcept;  ///< [1/s]
  /// ∫ h dt
  double integral(double from, double to) const noexcept;

  /// Knots at or before t: the index of the first one after it.
  std::size_t passed(double t) const noexcept;
  /// Growth of h and of its slope at a knot.
  double jump(std::size_t knot) const noexcept { return knot == 0 ? value[0] : 0; }
  double kink(std::size_t knot) const noexcept {
    return slope_after(knot) - (knot == 0 ? 0 : slope_after(knot - 1));
  }

 private:
  double slope_after(std::size_t knot) const noexcept;
};

}  // namespace ricochet::contact
