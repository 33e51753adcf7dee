// SPDX-License-Identifier: BSD-2-Clause
// The figures of bodies that turn by any angle, and their touches.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "contact/figures/figure_observer.hpp"
#include "contact/figures/rigid_motion.hpp"
#include "contact/figures/rotation_check.hpp"
#include "tests/contact/cloud.hpp"

namespace ricochet::contact::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Observes a flight of 0.05 s.
RotationCheck check_of(Model& model, double wave_speed, Rotation rotation = Rotation::finite) {
  const auto stepper = make_stepper(model, stepping(1e4, rotation));
  RotationCheck check(model, wave_speed);
  for (int k = 0; k < 500; ++k) {
    EXPECT_EQ(stepper->step(), StepStatus::ok);
    check.observe(*stepper);
  }
  return check;
}

std::vector<std::string> warnings(Model& model, double wave_speed, Rotation rotation = Rotation::finite) {
  return check_of(model, wave_speed, rotation).warnings();
}

TEST(RotationCheck, states_the_strain_and_the_coupling_that_are_neglected) {
  Cloud cloud({0.1, 0.1, 0.1}, 500, 0, 4);
  double radius = 0;
  for (std::size_t k = 0; k < 27; ++k)
    if (k != 13) radius = std::max(radius, (cloud.place[k] - cloud.centre).norm());
  const double spin = 40;
  const auto model = over_floor(cloud, {.spin = {0, 0, spin}, .height = 5, .gravity = {0, 0, 0}});
  for (int n = 7; n < 81; ++n) model->omega(n) = 1.05 * model->omega(n - 1);
  // The spin of a free body varies by some per cent, as its axis is nearly a principal one.
  EXPECT_THAT(warnings(*model, spin * radius / std::sqrt(0.8e-3)), IsEmpty());
  EXPECT_THAT(
      warnings(*model, spin * radius / std::sqrt(1.2e-3)),
      ElementsAre(AllOf(HasSubstr("cloud spins at 4"), HasSubstr("centrifugal strain, about 0.0012"))));
  EXPECT_THAT(warnings(*model, 0), IsEmpty()) << "the wave speed is not known";

  model->omega(9) = 1.01 * model->omega(8);
  // 40 rad/s · 0.05 s are 115 degrees.
  EXPECT_THAT(warnings(*model, 0),
              ElementsAre(AllOf(HasSubstr("modes 9 and 10 of cloud"), HasSubstr("up to the 11"))));
  const auto linear =
      over_floor(cloud, {.spin = {0, 0, spin}, .height = 5, .gravity = {0, 0, 0}, .turns = false});
  linear->omega = model->omega;
  EXPECT_THAT(warnings(*linear, 1, Rotation::linear), IsEmpty());
  EXPECT_THAT(check_of(*linear, 1, Rotation::linear).neglected(), IsEmpty());

  const auto sizes = [&] { return check_of(*model, 100).neglected().at("cloud"); };
  EXPECT_NEAR(*sizes().centrifugal_strain, std::pow(spin * radius / 100, 2),
              0.1 * std::pow(spin * radius / 100, 2));
  EXPECT_NEAR(sizes().frequency_shift, std::pow(spin / model->omega(6), 2), 1e-5);
  EXPECT_EQ(sizes().mode_mixing, 1) << "the spin is faster than the two modes are apart";
  cloud.kernel.modes.coriolis = {.pair = {8, 9}, .coupling = {0, 0, 0.5}};
  EXPECT_THAT(warnings(*model, 0), IsEmpty());
  // The lowest two modes are the nearest that are left, 5 % apart.
  EXPECT_NEAR(sizes().mode_mixing, 2 * spin / (0.05 * model->omega(6)), 0.05);
  EXPECT_EQ(sizes().compression, 0);
  const std::size_t rows = 3 * cloud.kernel.surface.size();
  kernels::CompactFlexibility& compact = cloud.kernel.surface.compact.emplace();
  compact.whole.assign(rows * rows, 0);
  compact.error = 0.25;
  EXPECT_EQ(sizes().compression, 0.25);
}

/// A rigid body bounces: each touch is a sequence of steps with a force, and its impulse is the change of
/// momentum, of force and weight.
TEST(Touches, are_the_sequences_of_steps_with_a_force_of_a_pair) {
  const Cloud cloud({0.05, 0.04, 0.03}, 2000, 1e-8, 6);
  const auto model =
      over_floor(cloud, {.rotation = turn(0.4, {1, 0.5, 0}), .spin = {3, 9, 0}, .height = 2e-3});
  const auto stepper = make_stepper(model, stepping(1e5));
  FigureObserver observer(*model, 1e-5);
  std::vector<Touch> expected;
  bool touching = false;
  double before = stepper->poses()[0].velocity.z();
  for (int k = 1; k <= 10'000; ++k) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    observer.observe(*stepper);
    const double now = stepper->poses()[0].velocity.z(), impulse = cloud.mass * (now - before + 9.81e-5);
    before = now;
    const bool pressed = impulse > 1e-14 * cloud.mass;
    if (pressed && !touching) expected.push_back({.start_s = 1e-5 * (k - 1), .end_s = {}});
    touching = pressed;
    if (!pressed) continue;
    expected.back().end_s = 1e-5 * k;
    expected.back().impulse.z() -= impulse;
  }
  ASSERT_FALSE(touching);
  const std::vector<Touch> found = observer.figures().touches;
  ASSERT_GE(expected.size(), 3);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t k = 0; k < found.size(); ++k) {
    EXPECT_NEAR(found[k].start_s, expected[k].start_s, 1e-12) << k;
    EXPECT_NEAR(found[k].end_s.value(), expected[k].end_s.value(), 1e-12) << k;
    EXPECT_LT((found[k].impulse - expected[k].impulse).norm(), 1e-9 * expected[k].impulse.norm() + 1e-14)
        << k;
    EXPECT_EQ(found[k].a + found[k].b, "cloudfloor");
  }
}

/// Points pass from face to face and from crease to crease while they press.
TEST(Touches, of_bodies_that_turn_have_the_impulses_that_change_their_momenta) {
  const Cloud one({0.1, 0.08, 0.06}, 2000, 1e-8, 5), other({0.1, 0.08, 0.06}, 2000, 1e-8, 7);
  std::vector<PlacedBody> bodies{
      {.name = "one", .kernel = &one.kernel, .rotation = turn(0.9, {1, 2, 0})},
      {.name = "other", .kernel = &other.kernel, .translation = {0.12, 0.01, 0.02}}};
  bodies[0].velocity = {3, 0, 0};
  bodies[0].angular_velocity = {20, -10, 30};
  bodies[1].angular_velocity = {-10, 25, 15};
  PairRequest pair{"one", "other", {}, {}, {}};
  pair.everywhere = true;
  const auto model = std::make_shared<Model>(build_model(bodies, {}, {pair}, Vector3d::Zero()));
  const auto stepper = make_stepper(model, stepping(1e5));
  FigureObserver observer(*model, 1e-5);
  const Vector3d before = stepper->poses()[1].velocity;
  for (int k = 0; k < 4000; ++k) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    observer.observe(*stepper);
  }
  Vector3d impulse = Vector3d::Zero();
  for (const Touch& touch : observer.figures().touches) impulse += touch.impulse;
  const Vector3d gained = other.mass * (stepper->poses()[1].velocity - before);
  ASSERT_GT(gained.norm(), 0.1);
  EXPECT_LT((impulse - gained).norm(), 1e-12 * gained.norm());
}

/// For small rotations, both descriptions agree but for the square of the angle.
TEST(Pose, of_linear_rotations_is_that_of_finite_ones_at_small_angles) {
  const Cloud cloud({0.1, 0.08, 0.06}, 500, 0, 4);
  Drop drop{.rotation = turn(0.7, {1, 2, 3}), .velocity = {1, 0, 0}, .spin = {0.2, -0.1, 0.3}, .height = 5};
  const auto model = over_floor(cloud, drop);
  const auto finite = make_stepper(model, stepping(1e3));
  drop.turns = false;
  const auto linear = make_stepper(over_floor(cloud, drop), stepping(1e3, Rotation::linear));
  const RigidMotions motions(*model);
  const Pose start = motions.pose(0, *linear);
  for (int k = 0; k < 20; ++k) {
    ASSERT_EQ(finite->step(), StepStatus::ok);
    ASSERT_EQ(linear->step(), StepStatus::ok);
  }
  const Pose one = motions.pose(0, *finite), other = motions.pose(0, *linear);
  EXPECT_LT((one.position - other.position).norm(), 1e-12);
  EXPECT_LT((one.velocity - other.velocity).norm(), 1e-12);
  EXPECT_NEAR(one.attitude.angularDistance(start.attitude), 0.02 * std::sqrt(0.14), 1e-4);
  EXPECT_LT(one.attitude.angularDistance(other.attitude), 1e-4);
  EXPECT_LT((one.spin - other.spin).norm(), 0.01 * one.spin.norm());
}

}  // namespace
}  // namespace ricochet::contact::test
