// SPDX-License-Identifier: BSD-2-Clause
// A rigid body that spins about the vertical falls on its lowest point, a spring: all of its motion is known.
#include "contact/accuracy/first_touch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "contact/figures/linearity_check.hpp"
#include "tests/contact/rigid_body.hpp"

namespace first_touch_test {

using namespace ricochet;
using namespace ricochet::contact;
using namespace ricochet::contact::test;

constexpr double mass = 2, radius = 0.05, flexibility = 1e-8, height = 0.1, speed = 1, gravity = 9.81;

/// When the point touches the floor, how fast it then is, and how long it touches.
const double when = (std::sqrt(speed * speed + 2 * gravity * height) - speed) / gravity,
             fast = speed + gravity * when, lasts = std::numbers::pi * std::sqrt(mass * flexibility);

struct Fall {
  kernels::Kernel kernel = rigid_body(mass, {1e-3, 1e-3, 2e-3}, {{0, 0, -radius}}, flexibility);
  std::shared_ptr<const Model> model;

  /// @param push  force along x [N]; 0: none
  explicit Fall(double spin, double down = speed, double push = 0) {
    std::vector<ForcingRequest> forcing;
    if (push != 0) {
      kernels::Load load{.name = "push", .unit = "N", .participation = kernel.loads.body_force};
      for (double& x : load.participation) x /= mass;
      load.total = {1, 0, 0, 0, 1, 0, 0, 0, 1};
      load.moment.assign(9, 0);
      load.residual.assign(9, 0);
      kernel.applied = {load};
      forcing = {{.body = "body", .name = "push", .vector = {push, 0, 0}}};
    }
    PlacedBody body{.name = "body", .kernel = &kernel};
    body.velocity = {0.3, 0, -down};
    body.angular_velocity = {0, 0, spin};
    PairRequest pair{"body", "floor", {}, height, {}};
    pair.everywhere = true;
    model =
        std::make_shared<const Model>(build_model({body}, {{.name = "floor", .normal = Vector3d::UnitZ()}},
                                                  {pair}, {0, 0, down == speed ? -gravity : 0}, forcing));
  }
  std::optional<FirstTouch> touch(double rate, double duration = 0.2) const {
    StepOptions options = stepping(rate);
    options.block = StepOptions{}.block;
    return find_first_touch(*model, options, duration);
  }
};

/// At 2 kHz, the touch has one step, so that shorter steps must find its end.
TEST(FirstTouch, is_that_of_the_closed_form) {
  const double spin = 3;
  const Fall fall(spin);
  for (const double rate : {2e3, 44.1e3, 1e6}) {
    const auto touch = fall.touch(rate);
    ASSERT_TRUE(touch);
    const double step = lasts / 16;  // the longest with which a touch is accepted
    EXPECT_NEAR(touch->end, when + lasts, 3 * step) << rate;
    EXPECT_NEAR(touch->until, when + 2 * lasts, 6 * step) << rate;
    // A hundredth of the radius before it, at the speed of the fastest point.
    const double before = 0.01 * radius / (fast + radius * spin);
    EXPECT_NEAR(touch->from, when - before, step + 0.1 * before) << rate;
    ASSERT_EQ(touch->poses.size(), 1);
    const Pose& pose = touch->poses[0];
    const double t = touch->from;
    EXPECT_NEAR(pose.position.z() - fall.model->bodies[0].centre.z(), -speed * t - gravity * t * t / 2,
                1e-13);
    EXPECT_NEAR(pose.position.x() - fall.model->bodies[0].centre.x(), 0.3 * t, 1e-13);
    EXPECT_NEAR(pose.velocity.z(), -speed - gravity * t, 1e-13);
    EXPECT_NEAR(pose.spin.z(), spin, 1e-13);
    EXPECT_LT(
        pose.attitude.angularDistance(Eigen::Quaterniond(Eigen::AngleAxisd(spin * t, Vector3d::UnitZ()))),
        1e-9);
    EXPECT_NEAR(touch->turned, spin * (touch->end - t), 1e-9);
    EXPECT_EQ(touch->pairs, std::vector<std::size_t>{0});
  }
}

TEST(FirstTouch, is_cut_where_a_body_turns_too_far_for_linear_rotations) {
  const double spin = 400;  // 10° while it touches
  const auto touch = Fall(spin).touch(1e6);
  ASSERT_TRUE(touch);
  EXPECT_NEAR(touch->until - touch->from, largest_linear_rotation / spin, 2e-6);
  EXPECT_EQ(touch->end, touch->until);
  EXPECT_LT(touch->end, when + 0.6 * lasts);
}

/// A load may let the body vibrate, so that the part begins where the run does; there, linear rotations must
/// reach up to the touch.
TEST(FirstTouch, of_a_body_under_a_load_begins_with_the_run) {
  const double spin = 0.5;
  const auto touch = Fall(spin, speed, 0.1).touch(44.1e3);
  ASSERT_TRUE(touch);
  EXPECT_EQ(touch->from, 0);
  EXPECT_LT((touch->poses[0].velocity - Vector3d(0.3, 0, -speed)).norm(), 1e-14);
  EXPECT_NEAR(touch->end, when + lasts, 3 * lasts / 16);
  EXPECT_NEAR(touch->turned, spin * touch->end, 1e-9);
  EXPECT_THROW(Fall(3, speed, 0.1).touch(44.1e3), InputError);  // it turns by 16°
}

TEST(FirstTouch, ends_with_the_run) {
  const double duration = when + lasts / 2;
  const auto touch = Fall(3).touch(1e6, duration);
  ASSERT_TRUE(touch);
  EXPECT_NEAR(touch->end, duration, 2e-6);
  EXPECT_NEAR(touch->until, duration, 2e-6);
}

TEST(FirstTouch, is_none_if_nothing_touches) {
  EXPECT_FALSE(Fall(3).touch(44.1e3, 0.9 * when));
  EXPECT_FALSE(Fall(3, -0.1).touch(44.1e3));
}

TEST(FirstTouch, can_be_ended_while_it_is_searched_for) {
  struct Stop {};
  const Fall fall(3);
  EXPECT_THROW(find_first_touch(*fall.model, stepping(44.1e3), 0.2, [] { throw Stop{}; }), Stop);
}

}  // namespace first_touch_test
