// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/shock.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace ricochet::contact {
namespace {

/// A filter of second order. @param y  of the last two samples
struct Biquad {
  double b0, b1, b2, a1, a2;  ///< y_k = b₀ x_k + b₁ x_{k−1} + b₂ x_{k−2} − a₁ y_{k−1} − a₂ y_{k−2}
  double x1 = 0, x2 = 0, y1 = 0, y2 = 0;

  double next(double x) {
    const double y = b0 * x + b1 * x1 + b2 * x2 - a1 * y1 - a2 * y2;
    x2 = x1, x1 = x;
    y2 = y1, y1 = y;
    return y;
  }
};

Biquad low_pass(double rate, double channel_class) {
  const double tangent = std::tan(std::numbers::pi * 2.0775 * channel_class / rate),
               square = tangent * tangent, all = 1 + std::numbers::sqrt2 * tangent + square,
               a0 = square / all;
  return {a0, 2 * a0, a0, -2 * (1 - square) / all, -(-1 + std::numbers::sqrt2 * tangent - square) / all};
}

}  // namespace

void filter_channel(std::span<double> x, double rate, double channel_class, double rest) {
  const Biquad filter = low_pass(rate, channel_class);
  // Its response decays by exp(−ω_d t/√2); beyond 25 of these times, nothing of it is left.
  const auto tail = static_cast<std::size_t>(
      std::ceil(25 * rate / (std::numbers::sqrt2 * std::numbers::pi * 2.0775 * channel_class)));
  std::vector<double> y(x.size() + tail);
  Biquad forwards = filter, backwards = filter;
  for (std::size_t k = 0; k < y.size(); ++k) y[k] = forwards.next(k < x.size() ? x[k] - rest : 0);
  for (std::size_t k = y.size(); k-- > 0;) {
    const double value = backwards.next(y[k]);
    if (k < x.size()) x[k] = value + rest;
  }
}

std::vector<double> shock_response(std::span<const double> x, double rate, std::span<const double> frequency,
                                   double quality, double rest) {
  std::vector<double> out;
  for (const double hz : frequency) {
    const double turn = 2 * std::numbers::pi * hz / rate, decay = turn / (2 * quality),
                 angle = turn * std::sqrt(1 - 1 / (4 * quality * quality)), e = std::exp(-decay),
                 c = e * std::cos(angle), s = e * std::sin(angle) / angle;
    Biquad oscillator{1 - s, 2 * (s - c), e * e - s, -2 * c, e * e};
    double largest = 0;
    for (const double value : x) largest = std::max(largest, std::abs(oscillator.next(value - rest) + rest));
    // After the end, the first swing is the largest one.
    const auto period = static_cast<std::size_t>(std::ceil(rate / hz));
    for (std::size_t k = 0; k < period; ++k) largest = std::max(largest, std::abs(oscillator.next(0) + rest));
    out.push_back(largest);
  }
  return out;
}

}  // namespace ricochet::contact
