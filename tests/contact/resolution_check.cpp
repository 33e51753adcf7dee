// SPDX-License-Identifier: BSD-2-Clause
// Each warning is issued for a run that deserves it, and not for a similar run that does not.
#include "contact/figures/resolution_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "contact/figures/summary_observer.hpp"
#include "tests/contact/plate.hpp"

namespace resolution_check_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;

std::vector<std::string> warnings_of(const Model& model, double duration, double step) {
  const auto stepper = make_stepper(model, {.step = step});
  SummaryObserver observer(model, step, 0);
  while (stepper->time() < duration) {
    EXPECT_EQ(stepper->step(), StepStatus::ok);
    observer.observe(*stepper);
  }
  return observer.summary().warnings;
}

/// Last time before the peak at which the force was below half of it, by a search of the whole history.
double rise_of(const std::vector<double>& force) {
  const std::size_t peak = std::ranges::max_element(force) - force.begin();
  std::size_t k = peak;
  while (k > 0 && force[k - 1] >= 0.5 * force[peak]) --k;
  return static_cast<double>(peak + 1 - k);  // the force is 0 before the first step
}

TEST(PeakRise, equals_that_found_in_the_whole_history) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(0, 1);
  for (int trial = 0; trial < 200; ++trial) {
    PeakRise rise;
    std::vector<double> force;
    double walk = 0;
    for (int k = 0; k < 300; ++k) {
      walk = std::max(0.0, 0.9 * walk + any(random) - 0.4);
      force.push_back(trial % 2 == 0 ? any(random) : walk);
      rise.observe(k + 1, force.back());
    }
    EXPECT_EQ(rise.peak(), *std::ranges::max_element(force));
    // Forces that differ by 2 % may count as equal: the bound of half the peak may be off by as much.
    std::vector<double> above = force, below = force;
    const double half = 0.5 * rise.peak();
    for (double& f : above) f = f < half && f >= half / 1.02 ? half : f;
    EXPECT_GE(rise.rise(), rise_of(force) - 1e-9) << trial;
    EXPECT_LE(rise.rise(), rise_of(above) + 1e-9) << trial;
  }
}

// sin(π/6) = 1/2: a half sine of duration T rises from half its peak in T/3.
TEST(PeakRise, of_a_half_sine_is_a_third_of_its_duration) {
  PeakRise rise;
  constexpr int steps = 3000;
  for (int k = 1; k <= steps; ++k) rise.observe(k, std::sin(k * std::numbers::pi / steps));
  // 2 %: forces within this share count as equal.
  EXPECT_NEAR(rise.rise(), steps / 3.0, 0.02 * steps);
  EXPECT_NEAR(rise.time(), steps / 2.0, 1);
}

TEST(PeakMean, equals_that_found_in_the_whole_history) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(0, 1);
  for (const int window : {1, 3, 50})
    for (int trial = 0; trial < 20; ++trial) {
      PeakMean mean(static_cast<std::size_t>(window), 0.5);
      std::vector<double> force(static_cast<std::size_t>(window), 0.0);
      int flight = 0;
      for (int k = 0; k < 400; ++k) {
        if (flight == 0 && any(random) < 0.02) flight = 1 + static_cast<int>(random() % 80);
        flight = std::max(0, flight - 1);
        force.push_back(flight > 0 ? 0 : any(random));
        if (flight == 0)
          mean.observe(0.5 * (k + 1), force.back());  // steppers leave out the steps of a flight
      }
      double peak = 0;
      for (std::size_t k = static_cast<std::size_t>(window); k <= force.size(); ++k)
        peak = std::max(peak, std::accumulate(force.begin() + k - window, force.begin() + k, 0.0) / window);
      EXPECT_NEAR(mean.peak(), peak, 1e-12);
      EXPECT_EQ(mean.window(), 0.5 * window);
    }
}

/// A free rod of length 10 and wave speed 1 that hits a wall at 1 m/s: a front.
Model rod_on_wall(const Kernel& kernel) {
  return build_model({{"rod", &kernel, Matrix3d::Identity(), Vector3d::Zero(), {1, 0, 0}}},
                     {{"wall", {10.005, 0, 0}, {-1, 0, 0}}}, {{"rod", "wall", {}, {}, {}}}, Vector3d::Zero());
}

TEST(Warnings, name_a_peak_that_one_band_does_not_resolve_and_none_of_a_smooth_pulse) {
  const Kernel elastic = rod(100, 10);
  EXPECT_THAT(warnings_of(rod_on_wall(elastic), 30, 0.01),
              ElementsAre(AllOf(HasSubstr("N is not resolved: it rose"), HasSubstr("Compare two bands")),
                          HasSubstr("times the end of the band of rod")));
  // A rigid mass on its residual flexibility gives half a sine.
  const Kernel massive = rod(1, 10);
  EXPECT_THAT(warnings_of(rod_on_wall(massive), 30, 0.01), IsEmpty());
}

// The wall feels Z v = 1 N until the front returns and releases it.
TEST(Warnings, name_every_peak_that_exceeds_that_of_a_front) {
  int released = 0, high = 0;
  for (const int modes : {20, 50, 100})
    for (const double step : {0.1, 0.04, 0.01, 0.003}) {
      const Kernel elastic = rod(modes, 10);
      const Model model = rod_on_wall(elastic);
      const auto stepper = make_stepper(model, {.step = step});
      SummaryObserver observer(model, step, 0);
      while (stepper->time() < 25) {
        ASSERT_EQ(stepper->step(), StepStatus::ok);
        observer.observe(*stepper);
      }
      const Summary found = observer.summary();
      const bool warned = std::ranges::any_of(
          found.warnings, [](const std::string& text) { return text.starts_with("the peak force"); });
      // The largest mean converges to 1 N. Where it is 5 % above it, steps or modes are coarse.
      if (found.peak_force_n > 1.12) {
        EXPECT_TRUE(warned) << modes << " modes, " << step << " s";
      }
      high += found.peak_force_n > 1.12;
      released += std::ranges::any_of(found.warnings, [](const std::string& text) {
        return text.find("ripple of a front that rises or is released") != std::string::npos;
      });
    }
  EXPECT_GE(high, 6);
  EXPECT_GE(released, 1);
}

/// A rigid plate falls on the first `lowest` of its candidates; the others are far above.
/// @param zone  beyond which candidates are dropped
std::vector<std::string> fall(int points, int lowest, std::optional<double> zone = {}) {
  Plate options{.modes = 1, .points = points};
  Kernel kernel = *plate(options);
  for (int i = lowest; i < points; ++i) kernel.surface.node[3 * i + 2] = 0.1;
  const Model model = build_model({{"plate", &kernel, Matrix3d::Identity(), {0, 0, 0.001}, {0, 0, -1}}},
                                  {{"floor", Vector3d::Zero(), Vector3d(0, 0, 1)}},
                                  {{"plate", "floor", {}, {}, {}, zone}}, Vector3d::Zero());
  return warnings_of(model, 0.01, 1e-6);
}

TEST(Warnings, name_a_zone_of_contact_with_few_candidates) {
  for (const int few : {1, 2})
    EXPECT_THAT(fall(8, few),
                ElementsAre(HasSubstr(std::to_string(few) +
                                      " of 8 candidates of plate touch at the same time (below 3)")));
  EXPECT_THAT(fall(8, 3), IsEmpty());
  EXPECT_THAT(fall(8, 8), IsEmpty());
  EXPECT_THAT(fall(2, 2), IsEmpty());  // all that there are
  EXPECT_THAT(fall(8, 1, 0.01),        // all that the zone has kept
              ElementsAre(HasSubstr("1 of 1 candidates of plate touch at the same time (below 3)")));
  EXPECT_THAT(fall(8, 3, 0.01), IsEmpty());
}

/// The first of eight candidates of a plate falls on another plate, and both bulge there.
std::vector<std::string> plates_meet(double bulge_of_upper, double bulge_of_lower) {
  Kernel upper = *plate({.modes = 1, .points = 8}), lower = *plate({.modes = 1, .points = 8});
  for (int i = 1; i < 8; ++i) upper.surface.node[3 * i + 2] = 0.1;
  upper.surface.bulge.assign(8, 0);
  lower.surface.bulge.assign(8, 0);
  upper.surface.bulge[0] = bulge_of_upper;
  lower.surface.bulge[0] = bulge_of_lower;
  const Matrix3d over = Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const Model model = build_model({{"upper", &upper, Matrix3d::Identity(), {0, 0, 0.001}, {0, 0, -1}},
                                   {"lower", &lower, over, Vector3d::Zero(), Vector3d::Zero()}},
                                  {}, {{"upper", "lower", Vector3d(0, 0, -1), {}, {}}}, Vector3d::Zero());
  return warnings_of(model, 0.01, 1e-6);
}

TEST(Warnings, name_the_more_curved_body_as_the_first_one_where_candidates_are_few) {
  const std::string advice = "lower is more curved there: name it before upper in between";
  EXPECT_THAT(plates_meet(1e-6, 2.1e-6),
              ElementsAre(AllOf(HasSubstr("1 of 8 candidates of upper touch"), HasSubstr(advice))));
  EXPECT_THAT(plates_meet(0, 1e-9), ElementsAre(HasSubstr(advice)));
  for (const auto& [of_upper, of_lower] : {std::pair{1e-6, 1.9e-6}, {2e-6, 1e-6}, {0.0, 0.0}, {0.0, -1e-6}})
    EXPECT_THAT(plates_meet(of_upper, of_lower),
                ElementsAre(AllOf(HasSubstr("1 of 8 candidates of upper touch"),
                                  testing::Not(HasSubstr("more curved")))));
}

TEST(Warnings, name_a_band_that_ends_below_the_contact) {
  Kernel kernel = *plate({.modes = 1, .points = 3});
  const auto warnings = [&](double upto_hz) {
    kernel.modes.certificate.upto_hz = upto_hz;
    return warnings_of(build_model({{"plate", &kernel, Matrix3d::Identity(), {0, 0, 0.001}, {0, 0, -1}}},
                                   {{"floor", Vector3d::Zero(), Vector3d(0, 0, 1)}},
                                   {{"plate", "floor", {}, {}, {}}}, Vector3d::Zero()),
                       0.01, 1e-6);
  };
  // A mass m on springs 1/R of three points: half a period, π √(m R/3) = 0.811 ms.
  EXPECT_THAT(warnings(1 / 0.9e-3), ElementsAre(AllOf(HasSubstr("a touch of 0.000811 s is shorter"),
                                                      HasSubstr("end of the band of plate"))));
  EXPECT_THAT(warnings(1 / 0.7e-3), IsEmpty());
  EXPECT_THAT(warnings(0), IsEmpty());  // not known
}

/// A rigid rod bounces between two walls; "left" is `way` away from its left end, and gravity acts to the
/// left.
std::vector<std::string> between_walls(double gravity, double way) {
  Kernel kernel = rod(1, 10);
  for (double& r : kernel.surface.residual_flexibility) r *= 1e-4;  // a touch of 0.2 s
  return warnings_of(
      build_model({{"rod", &kernel, Matrix3d::Identity(), Vector3d::Zero(), {1, 0, 0}}},
                  {{"right", {11, 0, 0}, {-1, 0, 0}}, {"left", {-way, 0, 0}, {1, 0, 0}}},
                  {{"rod", "right", {}, {}, {}}, {"rod", "left", {}, {}, {}}}, {-gravity, 0, 0}),
      12, 1e-3);
}

TEST(Warnings, name_an_approach_faster_than_the_first_one) {
  // From a rebound at √(1 − 0.2) m/s, 3 m of gravity 0.1 m/s² more: v² = 0.8 + 2·0.1·4 = 1.6 against 0.8.
  EXPECT_THAT(between_walls(0.1, 3),
              testing::Contains(
                  AllOf(HasSubstr("touch 2 begins at 1.2"), HasSubstr("faster than the first one at 0.89"))));
  // v² = 1 − 2g at the first wall and 1 + 2g·3 at the second: ratios of speeds of 1.04 and 1.06.
  EXPECT_THAT(between_walls(0.01, 3), testing::Not(testing::Contains(HasSubstr("faster than the first"))));
  EXPECT_THAT(between_walls(0.015, 3), testing::Contains(HasSubstr("faster than the first")));
}

TEST(Warnings, name_the_distance_at_which_bodies_miss) {
  const Kernel kernel = rod(1, 10);
  const Model model =
      build_model({{"rod", &kernel, Matrix3d::Identity(), Vector3d::Zero(), {1, 0, 0}}},
                  {{"wall", {15, 0, 0}, {-1, 0, 0}}}, {{"rod", "wall", {}, {}, {}}}, Vector3d::Zero());
  EXPECT_THAT(warnings_of(model, 4, 0.01),
              ElementsAre(HasSubstr("nothing touched: the smallest distance of a pair of points was 1 m")));
  EXPECT_THAT(warnings_of(model, 12, 0.01), IsEmpty());
}

}  // namespace resolution_check_test
