// SPDX-License-Identifier: BSD-2-Clause
// Flush-to-zero is active inside a scope, ends with it, and does not affect the results.
#include "ricochet/denormals.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <limits>
#include <vector>

#include "contact/model/model.hpp"
#include "contact/stepping/stepper.hpp"
#include "tests/contact/plate.hpp"

namespace denormals_test {

using namespace ricochet;
using contact::test::Plate;
using contact::test::plate;

/// Half of the smallest normal number, computed at run time.
double tiny() {
  volatile double smallest = std::numeric_limits<double>::min();
  return smallest / 2;
}

/// A denormal operand times a large number, computed at run time.
double revived() {
  volatile double denormal = std::numeric_limits<double>::denorm_min();
  return denormal * 1e300;
}

#if defined(__x86_64__) || defined(__aarch64__)
TEST(FlushDenormals, takes_denormals_for_zero_until_its_scope_ends) {
  ASSERT_GT(tiny(), 0);
  {
    const FlushDenormals scope;
    EXPECT_EQ(tiny(), 0);
    EXPECT_EQ(revived(), 0);
    {
      const FlushDenormals inner;
      EXPECT_EQ(tiny(), 0);
    }
    EXPECT_EQ(tiny(), 0);
  }
  EXPECT_GT(tiny(), 0);
  EXPECT_GT(revived(), 0);
}
#endif

TEST(FlushDenormals, leaves_rounding_and_exception_flags_alone) {
  std::feclearexcept(FE_ALL_EXCEPT);
  {
    const FlushDenormals scope;
    std::feraiseexcept(FE_DIVBYZERO);
    std::fesetround(FE_UPWARD);
  }
  EXPECT_TRUE(std::fetestexcept(FE_DIVBYZERO));
  EXPECT_EQ(std::fegetround(), FE_UPWARD);
  std::fesetround(FE_TONEAREST);
}

TEST(Simulation, leaves_the_mode_of_its_caller_alone) {
  Simulation simulation(contact::test::falling({}, 1e-4, 1, 9.81));
  simulation.step();
  simulation.step_block(100);
  EXPECT_GT(tiny(), 0);
}

/// A mallet flies up at a supported plate, which rings until its motion has decayed to nothing.
constexpr Plate struck{.modes = 6, .ratio = 0.4, .supported = true};
constexpr Plate mallet{.modes = 1, .points = 1, .mass = 0.01};

// 1e-300: some roundings of 2e-308 in a motion of order 1.
TEST(Simulation, of_a_dying_sound_is_the_same_with_and_without_denormals) {
  Scene scene;
  scene.bodies = {{.name = "plate", .kernel = plate(struck)},
                  {.name = "mallet",
                   .kernel = plate(mallet),
                   .rotate_deg = {180, 0, 0},
                   .translate = {0, 0, -1e-4},
                   .velocity = {0, 0, 1}}};
  scene.pairs = {{.a = "mallet", .b = "plate", .direction = Vector3{0, 0, 1}}};
  scene.pickups = {{.body = "plate", .direction = {0, 0, 1}}};
  constexpr std::size_t n = 8 * 44100;
  std::vector<double> sound(n);
  Simulation simulation(scene);
  ASSERT_EQ(simulation.step_block(n, {.velocity = sound.data()}).steps, n);

  contact::PlacedBody a{.name = "plate", .kernel = scene.bodies[0].kernel.get()};
  contact::PlacedBody b{.name = "mallet", .kernel = scene.bodies[1].kernel.get()};
  b.rotation = contact::test::upside_down();
  b.translation = {0, 0, -1e-4};
  b.velocity = {0, 0, 1};
  const contact::Model model = contact::build_model(
      {a, b}, {}, {{"mallet", "plate", Eigen::Vector3d(0, 0, 1), {}, {}}}, Eigen::Vector3d::Zero());
  const auto plain = contact::make_stepper(model, {.step = 1 / 44100.0});
  const contact::Vector w = -model.B.row(0).head(struck.modes).transpose();
  double largest = 0, difference = 0;
  std::size_t denormal_plain = 0;
  for (std::size_t k = 0; k < n; ++k) {
    ASSERT_EQ(plain->step(), ricochet::StepStatus::ok);
    const double v = w.dot(plain->modal()->v.head(struck.modes));
    largest = std::max(largest, std::abs(v));
    difference = std::max(difference, std::abs(v - sound[k]));
    denormal_plain += std::fpclassify(v) == FP_SUBNORMAL;
  }
  EXPECT_GT(largest, 0.01);
  EXPECT_LT(difference, 1e-300);
#if defined(__x86_64__) || defined(__aarch64__)
  EXPECT_GT(denormal_plain, 100);
  EXPECT_EQ(
      std::count_if(sound.begin(), sound.end(), [](double v) { return std::fpclassify(v) == FP_SUBNORMAL; }),
      0);
  EXPECT_LT(std::abs(sound.back()), 1e-300);  // the remaining motion is less than 2e-308 per step
#endif
}

}  // namespace denormals_test
