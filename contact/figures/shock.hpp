// SPDX-License-Identifier: BSD-2-Clause
// What drop testers make of an acceleration: the channel filters of SAE J211-1, and the shock response
// spectrum.
#pragma once

#include <array>
#include <span>
#include <vector>

namespace ricochet::contact {

/// Channel frequency classes.
inline constexpr std::array channel_classes{60, 180, 600, 1000};

/// Lowest rate at which a signal of this class is sampled [Hz]. Source: ISO 6487.
constexpr double least_rate(double channel_class) { return 10 * channel_class; }

/// Filters the samples in place by the low-pass of a channel class: a Butterworth filter of second order,
/// forwards and backwards, so that it delays nothing. At 5/3 of the class, its gain is 1/√2.
///
///   y_k = a₀ (x_k + 2 x_{k−1} + x_{k−2}) + b₁ y_{k−1} + b₂ y_{k−2}
///   ω_a = tan(ω_d T/2),   ω_d = 2π · 2.0775 CFC,   a₀ = ω_a² / (1 + √2 ω_a + ω_a²),
///   b₁ = 2 (1 − ω_a²) / (1 + √2 ω_a + ω_a²),   b₂ = (−1 + √2 ω_a − ω_a²) / (1 + √2 ω_a + ω_a²)
///
/// @param rate  1/T [Hz], at least least_rate()
/// @param rest  the signal before its first sample and after its last one
/// Source: SAE J211-1, appendix C.
void filter_channel(std::span<double> x, double rate, double channel_class, double rest = 0);

/// The largest |absolute acceleration| of an oscillator on a base with the acceleration x, while it lasts and
/// afterwards, for each natural frequency (maximax). The base moves as the straight lines between samples:
///
///   y_k = b₀ x_k + b₁ x_{k−1} + b₂ x_{k−2} + 2C y_{k−1} − E² y_{k−2}
///   b₀ = 1 − S',   b₁ = 2 (S' − C),   b₂ = E² − S',   S' = E sin K / K,   C = E cos K,
///   E = exp(−ω T/2Q),   K = ω T √(1 − 1/4Q²)
///
/// @param rate       1/T [Hz]
/// @param frequency  natural frequencies ω/2π [Hz]
/// @param quality    Q, above 1/2: the damping ratio is 1/2Q
/// @param rest       the signal before its first sample and after its last one
/// Source: ISO 18431-4; Smallwood 1981.
std::vector<double> shock_response(std::span<const double> x, double rate, std::span<const double> frequency,
                                   double quality, double rest = 0);

}  // namespace ricochet::contact
