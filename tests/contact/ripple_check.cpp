// SPDX-License-Identifier: BSD-2-Clause
// A spectral line above the band is found with its frequency and amplitude; pulses, lines within the band and
// lines far above it are not.
#include "contact/figures/ripple_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "contact/figures/summary_observer.hpp"
#include "tests/contact/plate.hpp"

namespace ripple_check_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;
using std::numbers::pi;

constexpr double band = 1000, rate = 16e3;

/// `shape` of the share of a touch that lasts `periods` of the band.
template <class Shape>
std::vector<double> touch(double periods, Shape shape) {
  std::vector<double> out;
  const auto samples = std::lround(periods * rate / band);
  for (long k = 0; k < samples; ++k)
    out.push_back(shape((static_cast<double>(k) + 0.5) / static_cast<double>(samples),
                        (static_cast<double>(k) + 0.5) / rate));
  return out;
}

double hertz(double x) { return std::pow(std::sin(pi * x), 1.5); }

TEST(ALine, above_the_band_is_found_with_its_frequency_and_amplitude) {
  for (const double frequency : {1.05 * band, 1.22 * band, 1.45 * band})
    for (const double periods : {12, 40, 100}) {
      const auto force =
          touch(periods, [&](double, double t) { return 10 + 3 * std::cos(2 * pi * frequency * t + 0.7); });
      const auto line = line_above(band, force, rate);
      ASSERT_TRUE(line) << frequency << ' ' << periods;
      // A quarter of 1/T is the distance of the frequencies tried. A Hann window loses at most 1.5 % of the
      // amplitude at half of it.
      EXPECT_NEAR(line->frequency, frequency, 0.2 * band / periods);
      EXPECT_NEAR(line->share, 0.3, 0.015 * 0.3 + 0.002);
    }
}

TEST(ALine, is_no_line_below_a_twentieth_of_the_mean_force) {
  const auto of = [&](double share) {
    return line_above(
        band,
        touch(30,
              [&](double x, double t) { return hertz(x) * (1 + share * std::sin(2 * pi * 1.2 * band * t)); }),
        rate);
  };
  EXPECT_TRUE(of(0.06));
  EXPECT_FALSE(of(0.04));
}

TEST(ALine, is_not_found_in_smooth_pulses_of_any_duration) {
  for (double periods = 0.5; periods < 60; periods *= 1.1) {
    EXPECT_FALSE(line_above(band, touch(periods, [](double x, double) { return hertz(x); }), rate))
        << periods;
    EXPECT_FALSE(line_above(band, touch(periods, [](double, double) { return 1.0; }), rate)) << periods;
    EXPECT_FALSE(line_above(band, touch(periods, [](double x, double) { return std::exp(-6 * x); }), rate))
        << periods;
  }
}

TEST(ALine, is_not_found_for_vibration_within_the_band_or_far_above) {
  for (const double frequency : {0.4 * band, 0.8 * band, 0.97 * band, 1.6 * band, 3 * band})
    for (const double periods : {15, 31, 64, 100}) {
      const auto force =
          touch(periods, [&](double, double t) { return 1 + 0.9 * std::cos(2 * pi * frequency * t + 0.2); });
      EXPECT_FALSE(line_above(band, force, rate)) << frequency << ' ' << periods;
    }
}

TEST(ALine, is_not_found_in_noise) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(0, 2);
  int found = 0;
  for (int trial = 0; trial < 100; ++trial)
    found += line_above(band, touch(50, [&](double, double) { return any(random); }), rate).has_value();
  EXPECT_LE(found, 2);
}

/// A plate lies on a floor under gravity and is let go from its relaxed position, so it vibrates on the
/// residual flexibility R of its three points at √(3/(R m))/2π, 1.233 kHz, between 0 and twice its weight.
/// Its elastic mode has no motion at the points: it only ends the band.
std::vector<std::string> warnings_with(double band_hz) {
  Kernel kernel = *plate({.modes = 2, .points = 3, .flexibility = 2.5e-8});
  for (std::size_t i = 0; i < 3; ++i) kernel.surface.shape[2 * i + 1] = 0;
  kernel.modes.angular_frequency[1] = 2 * pi * band_hz;
  const Model model = build_model({{"plate", &kernel, Matrix3d::Identity(), {0, 0, 0}}},
                                  {{"floor", Vector3d::Zero(), Vector3d(0, 0, 1)}},
                                  {{"plate", "floor", {}, {}, {}}}, {0, 0, -9.81});
  constexpr double step = 1e-5;
  const auto stepper = make_stepper(model, {.step = step});
  SummaryObserver observer(model, step, 0);
  while (stepper->time() < 0.05) {
    EXPECT_EQ(stepper->step(), StepStatus::ok);
    observer.observe(*stepper);
  }
  return observer.summary().warnings;
}

TEST(Ripple, of_a_run_is_named_with_its_frequency_and_the_remedy) {
  EXPECT_THAT(warnings_with(1000),
              ElementsAre(AllOf(HasSubstr("% of its mean at 123"),
                                HasSubstr("1.23 times the end of the band of plate (1000 Hz)"),
                                HasSubstr("Raise modes.up_to_hz"))));
  EXPECT_THAT(warnings_with(1300), IsEmpty());
  EXPECT_THAT(warnings_with(800), IsEmpty());  // 1.54 times
}

}  // namespace ripple_check_test
