// SPDX-License-Identifier: BSD-2-Clause
// Bodies stepped with max_pivots: permitted and forbidden effects of contact forces from a stopped solve.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "contact/stepping/stepper.hpp"
#include "tests/contact/heap_counter.hpp"
#include "tests/support.hpp"

namespace limited_steps_test {

using namespace ricochet::contact;
using ricochet::Energy;
using ricochet::Scheme;
using ricochet::StepStatus;

/// A body that flies at an obstacle or lies on it, with many points that touch at once. Its
/// modes span three decades, with or without damping, and its residual flexibility has any
/// size or is absent. Its weight acts on it.
Model flying(std::mt19937& random, Eigen::Index points) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0, 1);
  const Eigen::Index modes = 4 + static_cast<Eigen::Index>(20 * unit(random));
  Model model;
  model.omega = model.decay = model.load = model.q0 = model.v0 = Vector::Zero(modes);
  model.B = Matrix::NullaryExpr(points, modes, [&] { return normal(random); });
  model.B.col(0).setOnes();
  for (Eigen::Index n = 1; n < modes; ++n) model.omega(n) = std::pow(10, 1 + 3 * unit(random));
  if (unit(random) < 0.5) model.decay = 0.05 * model.omega;
  model.v0(0) = 1;
  model.load(0) = 10;
  model.gap = Vector::NullaryExpr(points, [&] { return unit(random) < 0.5 ? 0.0 : 1e-3 * unit(random); });
  model.static_displacement = Vector::Zero(points);
  model.R = Matrix::Zero(points, points);
  if (unit(random) < 0.6) {
    const Matrix A = Matrix::NullaryExpr(points, points, [&] { return normal(random); });
    model.R = std::pow(10, -3 - 5 * unit(random)) * A * A.transpose();
    model.has_residual = true;
  }
  model.area = Vector::Ones(points);
  return model;
}

// 1e-12 of the energies involved: round-off of one step.
TEST(LimitedStep, never_gains_energy_though_points_are_let_in) {
  std::mt19937 random(1);
  std::int64_t limited = 0, stopped = 0;
  for (int trial = 0; trial < 120; ++trial) {
    const Model model = flying(random, 4 + trial % 20);
    for (const double step : {1e-5, 1e-4, 1e-3}) {
      const auto stepper = make_stepper(model, {.contact = {.max_pivots = 1 + trial % 3}, .step = step});
      double size = stepper->modal()->energy().total();
      for (int k = 0; k < 400; ++k) {
        ASSERT_EQ(stepper->step(), StepStatus::ok);
        const Energy& energy = stepper->modal()->energy();
        size = std::max(size, energy.kinetic + energy.strain + std::abs(energy.loads));
        ASSERT_GE(energy.contact, -1e-12 * size) << trial << ' ' << step << ' ' << k;
        stopped += (stepper->displacement() - model.gap).maxCoeff() > 1e-9;
      }
      limited += stepper->solver().limited;
    }
  }
  EXPECT_GT(limited, 1000);
  EXPECT_GT(stopped, 5000);
}

TEST(LimitedStep, lets_no_point_in_deeper_once_the_forces_are_found) {
  std::mt19937 random(2);
  int steps_after = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Model model = flying(random, 12);
    const auto stepper = make_stepper(model, {.contact = {.max_pivots = 2}, .step = 1e-4});
    for (int k = 0; k < 400; ++k) {
      const Vector before = stepper->displacement().cwiseMax(model.gap);
      const auto limited = stepper->solver().limited;
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      if (stepper->solver().limited > limited) continue;
      EXPECT_EQ(stepper->residual().violation, 0);
      ASSERT_LE((stepper->displacement() - before).maxCoeff(), 1e-12) << trial << ' ' << k;
      steps_after += limited > 0;
    }
  }
  EXPECT_GT(steps_after, 1000);
}

/// A mass of 1 kg with a weight of 10 N that lies on six points of flexibility R [m/N].
Model on_six_points(double R) {
  Model model;
  model.omega = model.decay = model.load = model.q0 = model.v0 = Vector::Zero(1);
  model.B = Matrix::Ones(6, 1);
  model.R = R * Matrix::Identity(6, 6);
  model.has_residual = true;
  model.static_displacement = Vector::Zero(6);
  model.gap = Vector::Zero(6);
  model.area = Vector::Ones(6);
  model.load(0) = 10;
  return model;
}

TEST(LimitedStep, ends_without_penetration_after_the_bodies_have_parted) {
  Model model = on_six_points(1e-6);
  model.v0(0) = 1;  // returns 0.2 s after each bounce on R
  const auto stepper = make_stepper(model, {.contact = {.max_pivots = 5}, .step = 1e-4});
  int limited = 0;
  bool parted = false;
  for (int k = 0; k < 4000; ++k) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    const double depth = stepper->displacement().maxCoeff();
    if (stepper->solver().limited > limited) {
      limited = static_cast<int>(stepper->solver().limited);
      parted = false;
    }
    parted = parted || depth < 0;
    if (parted) {
      ASSERT_LE(depth, 1e-13) << k;
    }
  }
  EXPECT_GT(limited, 0);
}

// The mass sinks by R times its weight without a bounce. 1e-15: 20 000 rounding errors of this depth, 1.7e-4.
TEST(LimitedStep, rests_as_deep_as_it_was_left) {
  Model model = on_six_points(1e-4);
  model.decay(0) = 200;
  const auto stepper = make_stepper(model, {.contact = {.max_pivots = 5}, .step = 1e-4});
  ASSERT_EQ(stepper->step(), StepStatus::ok);
  ASSERT_EQ(stepper->solver().limited, 1);
  const double depth = stepper->displacement().maxCoeff();
  EXPECT_GT(depth, 1e-8);
  for (int k = 0; k < 20000; ++k) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    ASSERT_NEAR(stepper->displacement().maxCoeff(), depth, 1e-15) << k;
  }
  EXPECT_EQ(stepper->solver().limited, 1);
  EXPECT_NEAR(stepper->force().sum(), 10, 1e-6);
}

TEST(LimitedStep, reports_how_deep_it_let_a_point_in) {
  std::mt19937 random(3);
  int seen = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Model model = flying(random, 15);
    const auto stepper = make_stepper(model, {.contact = {.max_pivots = 2}, .step = 1e-4});
    for (int k = 0; k < 100; ++k) {
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      if (stepper->solver().limited == 0)
        continue;  // wait for the first limited step, which starts from u ≤ g
      const double depth = (stepper->displacement() - model.gap).maxCoeff();
      EXPECT_NEAR(stepper->residual().violation, std::max(depth, 0.0), 1e-15);
      EXPECT_GE(stepper->residual().scale, depth);
      ++seen;
      break;
    }
  }
  EXPECT_GT(seen, 30);
}

TEST(LimitedStep, never_gains_energy_by_impulses_either) {
  std::mt19937 random(4);
  std::int64_t limited = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Model model = flying(random, 15);
    const auto stepper = make_stepper(
        model, {.contact = {.scheme = Scheme::impulse, .restitution = 0.4 * (trial % 3), .max_pivots = 2},
                .step = 1e-4});
    double before = stepper->modal()->energy().total(), size = before;
    for (int k = 0; k < 400; ++k) {
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      const Energy& energy = stepper->modal()->energy();
      size = std::max(size, energy.kinetic + energy.strain + std::abs(energy.loads));
      ASSERT_LE(energy.total() - before, 1e-12 * size) << trial << ' ' << k;
      before = energy.total();
    }
    limited += stepper->solver().limited;
  }
  EXPECT_GT(limited, 500);
}

TEST(LimitedStep, is_the_plain_one_where_the_limit_is_not_met) {
  std::mt19937 random(5);
  for (const Scheme scheme : {Scheme::compliant, Scheme::impulse}) {
    const Model model = flying(random, 12);
    const auto plain = make_stepper(model, {.contact = {.scheme = scheme}, .step = 1e-4});
    const auto wide = make_stepper(model, {.contact = {.scheme = scheme, .max_pivots = 1000}, .step = 1e-4});
    for (int k = 0; k < 2000; ++k) {
      ASSERT_EQ(plain->step(), StepStatus::ok);
      ASSERT_EQ(wide->step(), StepStatus::ok);
      ASSERT_EQ(plain->modal()->q, wide->modal()->q);
      ASSERT_EQ(plain->force(), wide->force());
    }
    EXPECT_EQ(wide->solver().limited, 0);
    EXPECT_GT(wide->solver().pivots, 10);
  }
}

TEST(LimitedStep, needs_a_pivot_at_least) {
  std::mt19937 random(6);
  const Model model = flying(random, 3);
  EXPECT_EQ(ricochet::test::complaint_of(
                [&] { make_stepper(model, {.contact = {.max_pivots = 0}, .step = 1e-4}); }),
            "contact.max_pivots = 0: must be at least 1.");
}

#if RICOCHET_HEAP_COUNTED
TEST(LimitedStep, takes_no_memory) {
  std::mt19937 random(7);
  const Model model = flying(random, 40);
  const auto stepper = make_stepper(model, {.contact = {.max_pivots = 2}, .step = 1e-4});
  const long before = heap_counter::calls;
  for (int k = 0; k < 10000; ++k)
    if (stepper->step() != StepStatus::ok) break;
  const long after = heap_counter::calls;
  EXPECT_EQ(after, before);
  EXPECT_EQ(stepper->steps(), 10000);
  EXPECT_GT(stepper->solver().limited, 10);
}
#endif

}  // namespace limited_steps_test
