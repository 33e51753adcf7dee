// SPDX-License-Identifier: BSD-2-Clause
// Channel filters against the gains of SAE J211-1, and shock response spectra against closed forms and an
// integration of the oscillator.
#include "contact/figures/shock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

namespace ricochet::contact::shock_test {

constexpr double pi = std::numbers::pi;

/// The complex gain of a filter at a frequency, from the middle of a long tone.
std::complex<double> gain(double channel_class, double hz, double rate) {
  const auto period = rate / hz;
  const auto half = static_cast<std::size_t>(20 * period);  // beyond what the ends disturb
  std::vector<double> x(2 * half + static_cast<std::size_t>(std::ceil(10 * period)));
  for (std::size_t k = 0; k < x.size(); ++k) x[k] = std::cos(2 * pi * hz / rate * static_cast<double>(k));
  filter_channel(x, rate, channel_class);
  std::complex<double> sum = 0, all = 0;
  for (std::size_t k = half; k < x.size() - half; ++k) {
    const auto turn = std::polar(1.0, -2 * pi * hz / rate * static_cast<double>(k));
    sum += x[k] * turn;
    all += turn.real() * turn;
  }
  return sum / all;
}

double decibels(std::complex<double> gain) { return 20 * std::log10(std::abs(gain)); }

// SAE J211-1: −3 dB at 100, 300, 1000 and 1650 Hz; at the class, at most 1 dB below the gain of steady
// values. Rates are 40 times the class, at which frequencies are warped by less than 1 %.
TEST(ChannelFilter, has_the_gains_of_the_standard_and_no_delay) {
  const double corner[] = {100, 300, 1000, 1650};
  for (std::size_t k = 0; k < channel_classes.size(); ++k) {
    const double of = channel_classes[k], rate = 40 * of;
    EXPECT_NEAR(decibels(gain(of, corner[k], rate)), -3, 0.15) << of;
    EXPECT_NEAR(decibels(gain(of, of, rate)), -0.45, 0.05) << of;
    EXPECT_NEAR(decibels(gain(of, of / 4, rate)), 0, 0.005) << of;
    EXPECT_LT(std::abs(std::arg(gain(of, corner[k], rate))), 1e-3) << of;
    // −24 dB for each octave; the warping of frequencies adds 0.2 dB here.
    EXPECT_NEAR(decibels(gain(of, 16 * of, 400 * of)) - decibels(gain(of, 8 * of, 400 * of)), -24, 0.3) << of;
  }
}

TEST(ChannelFilter, keeps_the_change_of_velocity_and_steady_values) {
  std::vector<double> x(4000, -9.81);
  x[1500] += 1e4;
  filter_channel(x, 20e3, 180, -9.81);
  double sum = 0;
  for (const double value : x) sum += value + 9.81;
  EXPECT_NEAR(sum, 1e4, 1e-6);
  EXPECT_NEAR(x.front(), -9.81, 1e-9);
  EXPECT_NEAR(x[1500 - 20], x[1500 + 20], 1e-9);  // symmetric
}

// A pulse at the end of a run continues as the rest does: the run could as well have ended later.
TEST(ChannelFilter, does_not_depend_on_how_long_the_record_of_the_rest_is) {
  std::vector<double> brief(50, 2.0), longer(5000, 2.0);
  brief[49] = longer[49] = 900;
  brief[0] = longer[0] = -700;
  filter_channel(brief, 10e3, 60, 2);
  filter_channel(longer, 10e3, 60, 2);
  for (std::size_t k = 0; k < brief.size(); ++k) EXPECT_NEAR(brief[k], longer[k], 1e-7 * 900);
}

// An undamped oscillator on a base that moves by a half sine of duration τ, with Ω = π/τ and β = Ω/ω:
//   ÿ = (sin Ωt − β sin ωt)/(1 − β²) while it lasts, and 2β cos(π/2β)/(1 − β²) as amplitude afterwards.
TEST(ShockResponse, of_a_half_sine_is_the_closed_form) {
  const double tau = 1e-3, rate = 500e3;
  std::vector<double> x(static_cast<std::size_t>(tau * rate) + 1);
  for (std::size_t k = 0; k < x.size(); ++k) x[k] = std::sin(pi * static_cast<double>(k) / rate / tau);
  const std::vector<double> frequency{100, 300, 700, 1100, 2300, 6000};
  const std::vector<double> found = shock_response(x, rate, frequency, 1e9);
  for (std::size_t k = 0; k < frequency.size(); ++k) {
    const double beta = 1 / (2 * frequency[k] * tau);
    double largest = std::abs(2 * beta * std::cos(pi / (2 * beta)) / (1 - beta * beta));
    for (double t = 0; t < tau; t += tau / 1e4)
      largest = std::max(largest, std::abs(std::sin(pi * t / tau) - beta * std::sin(pi * t / tau / beta)) /
                                      std::abs(1 - beta * beta));
    EXPECT_NEAR(found[k], largest, 1e-3 * largest) << frequency[k];  // samples miss the tops of 6 kHz
  }
}

/// The largest |absolute acceleration| of an oscillator at the samples, and one period after them, by the
/// classical Runge–Kutta method with 200 steps for each sample.
double integrated(const std::vector<double>& x, double rate, double hz, double quality, double rest) {
  const double w = 2 * pi * hz, damping = w / quality;
  double z = -(rest) / (w * w), v = 0, largest = 0;  // of the mass relative to the base: z̈ = −a − c ż − ω² z
  const int parts = 200;
  const double h = 1 / rate / parts;
  const auto end = x.size() + static_cast<std::size_t>(std::ceil(rate / hz));
  const auto at = [&](std::size_t k) { return k < x.size() ? x[k] : rest; };
  double before = rest;
  for (std::size_t k = 0; k < end; ++k) {
    for (int part = 0; part < parts; ++part) {
      const auto base = [&](double s) { return before + (at(k) - before) * (part + s) / parts; };
      const auto slope = [&](double s, double p, double q) { return -base(s) - damping * q - w * w * p; };
      const double k1 = v, l1 = slope(0, z, v), k2 = v + h / 2 * l1, l2 = slope(0.5, z + h / 2 * k1, k2),
                   k3 = v + h / 2 * l2, l3 = slope(0.5, z + h / 2 * k2, k3), k4 = v + h * l3,
                   l4 = slope(1, z + h * k3, k4);
      z += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
      v += h / 6 * (l1 + 2 * l2 + 2 * l3 + l4);
    }
    before = at(k);
    largest = std::max(largest, std::abs(-damping * v - w * w * z));
  }
  return largest;
}

TEST(ShockResponse, of_any_shock_is_that_of_damped_oscillators) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::vector<double> x(60);
  for (double& value : x) value = 100 * normal(random);
  for (const double rest : {0.0, -9.81})
    for (const double quality : {0.7, 10.0, 50.0})
      for (const double hz : {30.0, 200.0, 900.0}) {
        const double wanted = integrated(x, 8e3, hz, quality, rest);
        EXPECT_NEAR(shock_response(x, 8e3, std::vector{hz}, quality, rest)[0], wanted, 1e-7 * wanted)
            << hz << ' ' << quality << ' ' << rest;
      }
}

}  // namespace ricochet::contact::shock_test
