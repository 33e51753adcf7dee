// SPDX-License-Identifier: BSD-2-Clause
// Velocities of the two sides of a contact, compared with d'Alembert's solution for elastic rods and with the
// motion that a rigid wall allows.
#include "contact/figures/contact_sides.hpp"

#include <gtest/gtest.h>

#include "tests/contact/bodies.hpp"

namespace contact_sides_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;

struct Row {
  double time, force, end_force, power;
  double u_a, u_b, v_a, v_b;
};

/// The steps with a force, of one contact point. @param every  steps between rows
std::vector<Row> rows_of(const Model& model, const StepOptions& options, int steps, int every = 1) {
  std::vector<Row> out;
  const auto folded = fold(borrowed(model), options);
  const auto stepper = make_stepper(folded, options);
  ContactSides sides(*folded, options);
  for (int k = 1; k <= steps; ++k) {
    EXPECT_EQ(stepper->step(), StepStatus::ok);
    if (stepper->force()(0) > 0 && k % every == 0) {
      const SidesMotion& now = sides.after(*stepper);
      out.push_back({stepper->time(), stepper->force()(0), stepper->end_force()(0), stepper->persistency(),
                     now.displacement_a(0), now.displacement_b(0), now.velocity_a(0), now.velocity_b(0)});
    }
    sides.pass(*stepper);
  }
  return out;
}

/// A rod of length 10 at speed 1 strikes a rod at rest, at t = 0. All c and ρcA are 1.
Model rods(const Kernel& striker, const Kernel& struck) {
  return build_model({{"striker", &striker, Matrix3d::Identity(), Vector3d::Zero(), {1, 0, 0}},
                      {"struck", &struck, Matrix3d::Identity(), {10, 0, 0}}},
                     {}, {{"striker", "struck", Vector3d(1, 0, 0), {}, {}}}, Vector3d::Zero());
}

/// A rod of length 10 at speed 1 strikes a rigid wall, 0.25 away.
Model rod_on_wall(const Kernel& kernel) {
  return build_model({{"rod", &kernel, Matrix3d::Identity(), Vector3d::Zero(), {1, 0, 0}}},
                     {{"wall", Vector3d(10.25, 0, 0), Vector3d(-1, 0, 0)}}, {{"rod", "wall", {}, {}, {}}},
                     Vector3d::Zero());
}

/// By d'Alembert, both ends move at 1/2 until the wave in the shorter rod, of length 5, returns at t = 10.
/// With 60 modes, the cut fronts of the waves leave ripples of about 5 % around it (Gibbs), whose mean over 6
/// s vanishes. The two ends move together to the round-off of u over the step.
TEST(SideVelocities, of_rods_are_those_of_d_Alembert) {
  const Kernel striker = rod(60, 10), struck = rod(60, 5);
  double sum = 0, square = 0, count = 0;
  for (const Row& row : rows_of(rods(striker, struck), {.step = 0.02}, 400)) {
    if (row.time < 2) continue;
    EXPECT_NEAR(row.v_b, row.v_a, 1e-11) << row.time;
    sum += row.v_a - 0.5;
    square += std::pow(row.v_a - 0.5, 2);
    ++count;
  }
  EXPECT_EQ(count, 301);
  EXPECT_NEAR(sum / count, 0, 1e-3);
  EXPECT_LT(std::sqrt(square / count), 0.05);
}

/// The bulge of the ends is flattened on both sides, in the ratio of their R, so that their points stay
/// together.
TEST(SideDisplacements, of_bulging_rods_differ_by_the_gap_while_they_touch) {
  const Kernel striker = rod(60, 10), struck = rod(40, 10);
  Model model = rods(striker, struck);
  model.bulge = Vector::Constant(1, 0.02);
  const StepOptions options{.step = 0.02};
  const auto stepper = make_stepper(model, options);
  ContactSides sides(model, options);
  int partial = 0;
  for (int k = 1; k <= 300; ++k) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    const SidesMotion& now = sides.after(*stepper);
    EXPECT_NEAR(now.displacement_a(0) - now.displacement_b(0), stepper->displacement()(0), 1e-12);
    const double force = stepper->end_force()(0);
    if (force > 0) {
      const auto spring = model.springs()[0];
      partial += force < spring.limit ? 1 : 0;
      double modes = 0;
      for (int n = 0; n < 60; ++n) modes += model.B(0, n) * stepper->modal()->q(n);
      EXPECT_NEAR(modes - now.displacement_a(0),
                  model.R_a(0, 0) * (force + spring.displacement(force) / model.R(0, 0)), 1e-12);
    }
    sides.pass(*stepper);
  }
  EXPECT_GT(partial, 100);
}

TEST(SideVelocities, of_a_point_pressed_on_a_rigid_wall_are_zero) {
  const Kernel kernel = rod(12, 10);
  for (const double step : {0.02, 0.6}) {  // 0.6: the modes above n = 16 would be quasi-static
    const Kernel fast = rod(20, 10);
    const auto rows = rows_of(rod_on_wall(step < 0.1 ? kernel : fast), {.step = step}, int(25 / step));
    int pressed = 0;
    for (std::size_t k = 1; k < rows.size(); ++k)
      if (rows[k].end_force > 0 && rows[k - 1].end_force > 0) {
        EXPECT_NEAR(rows[k].v_a, 0, 1e-11) << rows[k].time;
        EXPECT_EQ(rows[k].v_b, 0);
        ++pressed;
      }
    EXPECT_GT(pressed, 0.9 * 20 / step);  // contact lasts 2L/c = 20
  }
}

/// The power is that of the stepper, which knows nothing of the sides. 1e-12: round-off of u/Δ.
TEST(SideVelocities, give_the_power_and_the_displacement_of_the_steps) {
  const Kernel striker = rod(12, 10), struck = rod(9, 5);
  const double step = 0.02;
  for (const ContactStep law : {ContactStep::conserving, ContactStep::backward_euler})
    for (const int block : {0, 1}) {
      const StepOptions options{.contact = {.integration = law}, .step = step, .block = block};
      const auto rows = rows_of(rods(striker, struck), options, 450);
      double a = rows.front().u_a, b = rows.front().u_b;
      EXPECT_NEAR(rows.front().u_a, rows.front().v_a * step, 1e-14);  // contact begins in the first step
      for (std::size_t k = 1; k < rows.size(); ++k) {
        a += step * rows[k].v_a;
        b += step * rows[k].v_b;
        EXPECT_NEAR(rows[k].u_a, a, 1e-12);
        EXPECT_NEAR(rows[k].u_b, b, 1e-12);
        EXPECT_NEAR(-rows[k].force * (rows[k].v_a - rows[k].v_b), rows[k].power, 1e-12);
      }
    }
}

TEST(SideVelocities, do_not_depend_on_the_interval_of_rows) {
  const Kernel striker = rod(12, 10), struck = rod(9, 5);
  const Model model = rods(striker, struck);
  const auto all = rows_of(model, {.step = 0.02}, 300), some = rows_of(model, {.step = 0.02}, 300, 7);
  ASSERT_EQ(some.size(), 300U / 7);
  for (std::size_t k = 0; k < some.size(); ++k) {
    EXPECT_EQ(some[k].v_a, all[7 * k + 6].v_a);
    EXPECT_EQ(some[k].v_b, all[7 * k + 6].v_b);
  }
}

/// A bar stands 0.01 before a wall, and its foot advances by 0.02 within 10 s. The tip reaches the wall and
/// stays there, while the foot moves on. Modes above n = 4 are quasi-static with this step.
TEST(SideVelocities, are_zero_where_a_moving_support_presses_a_bar_on_a_wall) {
  const Kernel bar = clamped_bar(8, 1);
  const Model model =
      build_model({{"bar", &bar}}, {{"wall", Vector3d(1.01, 0, 0), Vector3d(-1, 0, 0)}},
                  {{"bar", "wall", {}, {}, {}}}, Vector3d::Zero(),
                  {{"bar", "foot", true, Vector3d(0.02, 0, 0), History{.time = {0, 10}, .value = {0, 1}}}});
  const double step = 0.2;
  const auto rows = rows_of(model, {.step = step}, 50);
  int pressed = 0;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    if (rows[k].time - rows[k - 1].time > 1.5 * step) continue;
    EXPECT_NEAR(rows[k].v_a, (rows[k].u_a - rows[k - 1].u_a) / step, 1e-14);
    if (!(rows[k].end_force > 0 && rows[k - 1].end_force > 0)) continue;
    EXPECT_NEAR(rows[k].v_a, 0, 1e-14);
    ++pressed;
  }
  EXPECT_GT(pressed, 15);
}

/// Equal rods share their momentum: with e = 0, the ends leave the impulse together at 1/2.
TEST(SideVelocities, under_impulses_are_those_just_after_them) {
  const Kernel kernel = rod(12, 10);
  const auto rows =
      rows_of(rods(kernel, kernel), {.contact = {.scheme = Scheme::impulse}, .step = 0.02}, 100);
  ASSERT_GT(rows.size(), 50U);
  for (const Row& row : rows) {
    EXPECT_NEAR(row.v_a, 0.5, 1e-12);
    EXPECT_NEAR(row.v_b, 0.5, 1e-12);
  }
}

}  // namespace contact_sides_test
