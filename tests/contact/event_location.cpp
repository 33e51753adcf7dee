// SPDX-License-Identifier: BSD-2-Clause
// Impulses at the exact instants at which points close.
#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "contact/stepping/stepper.hpp"
#include "tests/contact/bodies.hpp"
#include "tests/contact/heap_counter.hpp"

namespace event_location_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;

/// A rigid unit mass that moves along z. Its lowest point has the height 0 in its own frame.
Kernel mass() {
  Kernel kernel;
  kernel.mass = 1;
  add_candidate(kernel, {0, 0, 0}, {0, 0, -1}, 1);
  kernel.surface.element_corners = 1;
  kernel.surface.element = {0};
  kernel.modes.angular_frequency = {0};
  kernel.modes.decay_rate = {0};
  kernel.surface.shape = {0, 0, 1};
  kernel.loads.body_force = {0, 0, 1};
  kernel.loads.rotation = {0, 0, 0};
  kernel.applied = {{"hammer", "N", {0, 0, 1}, {1, 0, 0, 0, 1, 0, 0, 0, 1}, std::vector<double>(9, 0), {}}};
  return kernel;
}

Model above_floor(const Kernel& kernel, double height, double speed, double gravity,
                  const std::vector<ForcingRequest>& forcing = {}) {
  return build_model({{"mass", &kernel, Matrix3d::Identity(), {0, 0, height}, {0, 0, speed}}},
                     {{"floor", Vector3d::Zero(), Vector3d(0, 0, 1)}}, {{"mass", "floor", {}, {}, {}}},
                     {0, 0, -gravity}, forcing);
}

StepOptions exact(double step, double restitution = 0) {
  return {.contact = {.scheme = Scheme::impulse, .instant = Instant::exact, .restitution = restitution},
          .step = step};
}

// By Galilei's laws, bounce k leaves at e^k √(2gh), and the flight after it lasts twice this speed divided by
// g. The margin for touching, 2e-13 m of round-off, is 1e-13 s at each bounce.
TEST(ExactInstant, makes_a_mass_bounce_as_galilei_has_it) {
  const double gravity = 9.81, height = 0.7, restitution = 0.8, step = 0.0137;
  const Kernel kernel = mass();
  const Model model = above_floor(kernel, height, 0, gravity);
  const auto stepper = make_stepper(model, exact(step, restitution));
  double landing = std::sqrt(2 * height / gravity), speed = gravity * landing;
  int bounces = 0;
  double lost = 0;
  while (bounces < 12) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    const double t = stepper->time();
    if (t > landing) {
      EXPECT_NEAR(stepper->force()(0) * step, (1 + restitution) * speed, 1e-10) << bounces;
      lost += 0.5 * speed * speed * (1 - restitution * restitution);
      EXPECT_NEAR(stepper->modal()->energy().contact, lost, 1e-10);
      speed *= restitution;
      const double flight = t - landing;
      EXPECT_NEAR(-stepper->displacement()(0) + height, speed * flight - 0.5 * gravity * flight * flight,
                  1e-10);
      landing += 2 * speed / gravity;
      ++bounces;
    }
    EXPECT_LE(stepper->displacement()(0), height + 1e-12);
    EXPECT_LT(std::abs(stepper->modal()->energy().ledger()), 1e-11);
  }
}

// A force grows linearly from a knot within the step: z = F τ³/6 closes the
// gap 0.002 at τ = (6 · 0.002 / F)^{1/3}.
TEST(ExactInstant, is_found_under_a_load_that_grows_within_the_step) {
  const Kernel kernel = mass();
  const double gap = 0.002, growth = 20, start = 0.03, step = 0.2;
  const Model model = above_floor(
      kernel, gap, 0, 0, {{"mass", "hammer", false, {0, 0, -1}, {{start, 10}, {0, (10 - start) * growth}}}});
  const auto stepper = make_stepper(model, exact(step));
  ASSERT_EQ(stepper->step(), StepStatus::ok);
  const double flight = std::cbrt(6 * gap / growth), speed = growth * flight * flight / 2;
  ASSERT_LT(start + flight, step);
  const double met = start + flight, left = step - met;
  // After the impact the load pushes the mass from rest. It is beyond the
  // gap at t_1 and is stopped again there.
  const double again = growth * flight * left + growth * left * left / 2;
  EXPECT_NEAR(stepper->force()(0) * step, speed + again, 1e-10);
  EXPECT_NEAR(stepper->displacement()(0) - gap,
              growth * flight * left * left / 2 + growth * left * left * left / 6, 1e-10);
}

/// A support whose speed changes by `kick` at t = `knot`. The rigid mode gets that velocity, and the contact
/// point does not move with the support itself.
Model kicked(const Kernel& kernel, double gap, double knot, double kick) {
  Model model = above_floor(kernel, gap, 0, 0);
  Model::Forcing support;
  support.support = true;
  support.history = {{knot, knot + 1}, {0, kick}};
  support.force = Vector::Zero(1);
  support.lift = Vector::Constant(1, -1 / model.B(0, 0));
  support.displacement = support.displacement_a = Vector::Zero(1);
  model.forcing.push_back(support);
  return model;
}

// At the speed V from the knot on, the gap g closes g/V later; the floor then stops the mass.
TEST(ExactInstant, is_found_after_a_support_has_changed_its_speed) {
  const Kernel kernel = mass();
  const double gap = 0.002, speed = 0.1, step = 0.05;
  for (const double knot : {0.013, step}) {  // within the first step, and at its end
    const auto stepper = make_stepper(kicked(kernel, gap, knot, speed), exact(step));
    const int steps = knot < step ? 1 : 2;
    for (int k = 1; k <= steps; ++k) {
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      EXPECT_EQ(stepper->active(), k == steps) << knot;
    }
    EXPECT_NEAR(stepper->force()(0) * step, speed, 1e-12) << knot;
    EXPECT_NEAR(stepper->displacement()(0), gap, 1e-12) << knot;  // the margin for touching
  }
}

/// Two rods of unit impedance. The left one approaches the other across a gap at unit speed.
Model rods(const Kernel& kernel, double gap) {
  return build_model({{"left", &kernel, Matrix3d::Identity(), Vector3d::Zero(), {1, 0, 0}},
                      {"right", &kernel, Matrix3d::Identity(), {10 + gap, 0, 0}}},
                     {}, {{"left", "right", Vector3d(1, 0, 0), {}, {}}}, Vector3d::Zero());
}

// The rods move rigidly until they meet, so the instant is gap / 1 for any step.
TEST(ExactInstant, leaves_no_penetration_at_the_first_touch) {
  const Kernel kernel = rod(30, 10);
  for (const double gap : {0.0, 0.0037, 0.0999, 0.31}) {
    double deepest[2];
    for (const Instant instant : {Instant::step, Instant::exact}) {
      const auto stepper = make_stepper(
          rods(kernel, gap), {.contact = {.scheme = Scheme::impulse, .instant = instant}, .step = 0.1});
      while (stepper->active() == 0) ASSERT_EQ(stepper->step(), StepStatus::ok);
      EXPECT_EQ(stepper->steps(), static_cast<int>(gap / 0.1) + 1);
      deepest[instant == Instant::exact] = stepper->displacement()(0) - gap;
    }
    const double late = 0.1 * (static_cast<int>(gap / 0.1) + 1) - gap;
    EXPECT_NEAR(deepest[0], late, 1e-12);
    EXPECT_LT(deepest[1], 0.6 * late) << gap;  // penetration that builds up between the instant and t_k
  }
}

/// Many modes and points with random velocities. The reference searches
/// 20 000 instants of the step by brute force.
TEST(ExactInstant, is_the_first_at_which_any_point_closes) {
  const Kernel kernel = rod(12, 10);
  Model model = rods(kernel, 0.5);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const Eigen::Index m = 4, N = model.omega.size();
  const double step = 0.4;
  for (int trial = 0; trial < 50; ++trial) {
    Model many = model;
    many.B = Matrix::NullaryExpr(m, N, [&] { return normal(random); });
    many.R = many.R_a = Matrix::Zero(m, m);
    many.gap = Vector::Constant(m, 0.4);
    many.bulge = Vector::Zero(m);
    many.static_displacement = many.static_a = Vector::Zero(m);
    many.v0 = Vector::NullaryExpr(N, [&] { return 0.4 * normal(random); });
    many.decay = 0.1 * many.omega;
    // Free motion without contact on a fine time grid.
    Model free = many;
    free.gap.setConstant(1e9);
    constexpr int grid = 20000;
    const auto fine = make_stepper(free, {.contact = {.scheme = Scheme::impulse}, .step = step / grid});
    double first = step, speed = 0;
    int point = -1;
    for (int k = 1; k <= grid && point < 0; ++k) {
      fine->step();
      Eigen::Index i = 0;
      if (fine->displacement().maxCoeff(&i) > 0.4) {
        point = static_cast<int>(i);
        first = k * step / grid;
        speed = many.B.row(i).dot(fine->modal()->v);
      }
    }
    const auto stepper = make_stepper(many, exact(step));
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    EXPECT_EQ(stepper->active() > 0, point >= 0) << trial;
    if (point < 0) continue;
    // The contact energy is at least that of the first impulse: (u̇)² / 2A of the point that closes first.
    const double least = 0.5 * speed * speed / many.B.row(point).squaredNorm();
    EXPECT_GT(stepper->modal()->energy().contact, least * (1 - 1e-3)) << trial << " " << first;
    EXPECT_GT(stepper->force()(point), 0);
    EXPECT_LT(std::abs(stepper->modal()->energy().ledger() - fine->modal()->energy().ledger()),
              1e-11);  // 20 000 steps
  }
}

#if RICOCHET_HEAP_COUNTED
TEST(ExactInstant, takes_no_memory) {
  const Kernel kernel = rod(30, 10);
  for (const Admittance admittance : {Admittance::jump, Admittance::difference}) {
    const auto stepper = make_stepper(
        rods(kernel, 0.31),
        {.contact = {.scheme = Scheme::impulse, .admittance = admittance, .instant = Instant::exact},
         .step = 0.1});
    const long before = heap_counter::calls;
    for (int k = 0; k < 300; ++k)
      if (stepper->step() != StepStatus::ok) break;
    EXPECT_EQ(heap_counter::calls, before);
    EXPECT_EQ(stepper->steps(), 300);
  }
}
#endif

}  // namespace event_location_test
