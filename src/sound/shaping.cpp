// SPDX-License-Identifier: BSD-2-Clause
#include "src/sound/shaping.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ricochet::sound {
namespace {

/// A section of second order by the bilinear transform, H(s) = s²/(s² + s/Q + 1):
///   y_k = b (x_k − 2 x_{k−1} + x_{k−2}) − a₁ y_{k−1} − a₂ y_{k−2},   K = tan(π f/rate)
///   b = 1/(1 + K/Q + K²),   a₁ = 2 (K² − 1) b,   a₂ = (1 − K/Q + K²) b
void filter(std::vector<double>& x, double K, double Q) {
  const double b = 1 / (1 + K / Q + K * K), a1 = 2 * (K * K - 1) * b, a2 = (1 - K / Q + K * K) * b;
  double x1 = x.front(), x2 = x.front(), y1 = 0, y2 = 0;
  for (double& value : x) {
    const double y = b * (value - 2 * x1 + x2) - a1 * y1 - a2 * y2;
    x2 = x1;
    x1 = value;
    y2 = y1;
    y1 = value = y;
  }
}

}  // namespace

void high_pass(std::vector<float>& sound, int channels, double corner_hz, double rate_hz) {
  const double K = std::tan(std::numbers::pi * corner_hz / rate_hz);
  const auto width = static_cast<std::size_t>(channels);
  for (std::size_t channel = 0; channel < width && !sound.empty(); ++channel) {
    std::vector<double> x;
    for (std::size_t k = channel; k < sound.size(); k += width) x.push_back(sound[k]);
    for (const int pole : {1, 3}) filter(x, K, 1 / (2 * std::cos(pole * std::numbers::pi / 8)));
    for (std::size_t k = 0; k < x.size(); ++k) sound[k * width + channel] = static_cast<float>(x[k]);
  }
}

void fade_out(std::vector<float>& sound, int channels, double frames) {
  const auto width = static_cast<std::size_t>(channels);
  const double last = static_cast<double>(sound.size() / width) - 1;
  const double length = std::min(frames, last);
  for (std::size_t k = 0; k < sound.size(); ++k)
    if (const double left = last - static_cast<double>(k / width); left < length)
      sound[k] *= static_cast<float>((1 - std::cos(std::numbers::pi * left / length)) / 2);
}

}  // namespace ricochet::sound
