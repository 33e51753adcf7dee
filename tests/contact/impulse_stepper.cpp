// SPDX-License-Identifier: BSD-2-Clause
// The impulse scheme on bodies whose motion after contact is known.
#include "contact/stepping/stepper.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/contact/falling_body.hpp"

namespace impulse_stepper_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;

TEST(Impulse, returns_a_rigid_body_with_the_restitution_asked_for) {
  for (const double restitution : {0.0, 0.3, 1.0}) {
    Model model = dropped(1, 1, 0.05);
    model.load.setZero();
    model.v0(0) = 3 * std::sqrt(mass);
    const auto stepper = make_stepper(
        model, {.contact = {.scheme = Scheme::impulse, .restitution = restitution}, .step = 0.01});
    double impulse = 0;
    for (int k = 0; k < 10; ++k) {
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      impulse += stepper->force()(0) * 0.01;
    }
    EXPECT_NEAR(stepper->modal()->v(0) / std::sqrt(mass), -3 * restitution, 1e-10);
    EXPECT_NEAR(impulse, mass * 3 * (1 + restitution), 1e-10);  // momentum
    EXPECT_NEAR(stepper->modal()->energy().contact, 0.5 * mass * 9 * (1 - restitution * restitution), 1e-10);
  }
}

// A gap of a whole number of steps: u = g at its end except for round-off of either sign.
TEST(Impulse, meets_the_obstacle_at_the_step_that_reaches_it_to_round_off) {
  for (int steps = 1; steps <= 100; ++steps) {
    Model model = dropped(1, 1, 0.01 * steps);
    model.load.setZero();
    model.v0(0) = std::sqrt(mass);
    const auto stepper = make_stepper(model, {.contact = {.scheme = Scheme::impulse}, .step = 0.01});
    for (int k = 0; k < steps - 1; ++k) stepper->step();
    EXPECT_EQ(stepper->active(), 0) << steps;
    stepper->step();
    EXPECT_EQ(stepper->active(), 1) << steps;
  }
}

// Five points on one mode: only the sum of the impulses is determined. 1e-3: round-off ε relative to the term
// of 1e-12 that selects equal impulses.
TEST(Impulse, is_shared_evenly_by_points_that_are_alike) {
  Model model = dropped(1, 5, 0.01);
  model.load.setZero();
  model.v0(0) = std::sqrt(mass);
  const auto stepper = make_stepper(model, {.contact = {.scheme = Scheme::impulse}, .step = 0.02});
  ASSERT_EQ(stepper->step(), StepStatus::ok);
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(stepper->force()(i) * 0.02, mass / 5, 1e-3 * mass / 5);
  EXPECT_NEAR(stepper->force().sum() * 0.02, mass, 1e-11);
}

TEST(Impulse, never_gains_energy_and_stops_every_touching_point_with_more_points_than_modes) {
  for (int trial = 0; trial < 30; ++trial) {
    Model model = dropped(4, 12, 1e-3, static_cast<unsigned>(trial));
    const auto stepper = make_stepper(model, {.contact = {.scheme = Scheme::impulse}, .step = 1e-4});
    double before = stepper->modal()->energy().total();
    int touching = 0;
    for (int k = 0; k < 2000; ++k) {
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      ASSERT_LE(stepper->modal()->energy().total() - before, 1e-14);
      before = stepper->modal()->energy().total();
      const Vector rate = model.B * stepper->modal()->v;
      for (Eigen::Index i = 0; i < 12; ++i) {
        if (stepper->displacement()(i) > model.gap(i)) {
          ASSERT_LE(rate(i), 1e-10);
        }
      }
      touching += stepper->active() > 0;
    }
    EXPECT_GT(touching, 5);
  }
}

}  // namespace impulse_stepper_test
