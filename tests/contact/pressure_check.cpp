// SPDX-License-Identifier: BSD-2-Clause
// Warnings on pressure are issued just above their limits and not just below.
#include "contact/figures/pressure_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "contact/figures/equilibrium_summary.hpp"
#include "contact/figures/summary_observer.hpp"
#include "contact/static/equilibrium.hpp"
#include "tests/contact/plate.hpp"

namespace pressure_check_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;
using ::testing::Contains;
using ::testing::Not;

/// A rigid plate of 2 kg on springs of 1e7 N/m at three patches of 1 m², above a floor.
Model plate_on_floor(const Kernel& kernel, double height, double gravity) {
  return build_model(
      {{"plate", &kernel, Matrix3d::Identity(), {0, 0, height}, {0, 0, gravity > 0 ? 0. : -1.}}},
      {{"floor", Vector3d::Zero(), Vector3d(0, 0, 1)}}, {{"plate", "floor", {}, {}, {}}}, {0, 0, -gravity});
}

std::vector<std::string> warnings_of(const ricochet::MaterialLimits& limits,
                                     ricochet::Scheme scheme = ricochet::Scheme::compliant) {
  const Kernel kernel = *plate({.modes = 1, .points = 3});
  const Model model = plate_on_floor(kernel, 1e-3, 0);
  constexpr double step = 1e-6;
  const auto stepper = make_stepper(model, {.contact = {.scheme = scheme}, .step = step});
  SummaryObserver observer(model, step, 0, {limits});
  while (stepper->time() < 3e-3) {
    EXPECT_EQ(stepper->step(), StepStatus::ok);
    observer.observe(*stepper);
  }
  return observer.summary().warnings;
}

// At 1 m/s, the springs take √(2 kg · 3e7 N/m) · 1 m/s = 7746 N together: 2582 Pa on each patch. The margins
// of 1 % are far above the error of 800 steps in a touch.
constexpr double pressure = 2582;

TEST(Pressure, above_two_per_cent_of_the_modulus_is_named) {
  EXPECT_THAT(warnings_of({.young = pressure / 0.0202}),
              ElementsAre(AllOf(HasSubstr("the pressure on plate reaches 0.00258 MPa at 0.0014"),
                                HasSubstr("2.02 % of its Young's modulus (above 2 %)"))));
  EXPECT_THAT(warnings_of({.young = pressure / 0.0198}), IsEmpty());
}

TEST(Pressure, above_the_yield_stress_is_named) {
  EXPECT_THAT(warnings_of({.yield = pressure * 0.99}),
              ElementsAre(HasSubstr("reaches 0.00258 MPa at 0.0014")));
  EXPECT_THAT(warnings_of({.yield = pressure * 1.01}), IsEmpty());
}

TEST(Pressure, of_a_body_with_unknown_limits_is_not_judged) { EXPECT_THAT(warnings_of({}), IsEmpty()); }

TEST(Pressure, of_impulses_is_not_judged) {
  EXPECT_THAT(warnings_of({.young = 1, .yield = 1}, ricochet::Scheme::impulse),
              Not(Contains(HasSubstr("pressure"))));
}

// Two bodies bear the same pressure, so the softer one decides.
TEST(Pressure, is_compared_with_the_softer_body) {
  const Kernel kernel = *plate({.modes = 1, .points = 3}), below = *plate({.modes = 1, .points = 3});
  const Matrix3d over = upside_down();
  const Model model = build_model(
      {{"plate", &kernel, Matrix3d::Identity(), {0, 0, 0.001}}, {"anvil", &below, over, {0, 0, 0}}}, {},
      {{"plate", "anvil", Vector3d(0, 0, -1), {}, {}}}, Vector3d::Zero());
  PressureCheck check(model, {{.young = 1e6}, {.young = 1e3}});
  check.observe(Vector::Constant(model.rows(), 30), 0.5);
  EXPECT_THAT(check.warnings(),
              ElementsAre(HasSubstr("the pressure on anvil reaches 3e-05 MPa at 0.5 s, 3 %")));
}

// Forces of single points scatter where meshes do not match.
TEST(Pressure, is_the_mean_over_pressed_points_that_are_neighbours) {
  const Kernel kernel = *plate({.modes = 1, .points = 3});
  const Model model = plate_on_floor(kernel, 1e-3, 0);
  const auto found = [&](const Eigen::Vector3d& force) {
    PressureCheck check(model, {{.young = 1e3}});
    check.observe(force, 0.5);
    return check.warnings();
  };
  EXPECT_THAT(found({10, 50, 30}), ElementsAre(HasSubstr("reaches 3e-05 MPa at 0.5 s, 3 %")));
  EXPECT_THAT(found({0, 30, 0}), ElementsAre(HasSubstr("reaches 3e-05 MPa at 0.5 s, 3 %")));
  EXPECT_THAT(found({1, 50, 6}), IsEmpty());  // 19 Pa
}

// A weight of 2 kg · 9.81 m/s² on three patches: 6.54 Pa.
TEST(Pressure, of_bodies_at_rest_is_judged) {
  const Kernel kernel = *plate({.modes = 1, .points = 3});
  const Model model = plate_on_floor(kernel, 0, 9.81);
  const Equilibrium rest = find_equilibrium(model);
  EXPECT_THAT(summarise(model, rest, {{.young = 320, .yield = 6.5}}).warnings,
              ElementsAre(HasSubstr("2.04 % of its Young's modulus"), HasSubstr("above yield")));
  EXPECT_THAT(summarise(model, rest, {{.young = 330, .yield = 6.6}}).warnings, IsEmpty());
}

}  // namespace pressure_check_test
