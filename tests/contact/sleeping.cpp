// SPDX-License-Identifier: BSD-2-Clause
// Bodies at rest sleep while others move, and wake when these reach them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/contact/meeting.hpp"

namespace sleeping_test {

using namespace ricochet;
using namespace ricochet::contact;
using namespace ricochet::contact::test;
using Eigen::Vector3d;

constexpr double g = 9.81;

/// An elastic box of 0.1 × 0.08 × 0.06 m whose vibration ends within some periods.
Cloud damped() {
  Cloud box({0.1, 0.08, 0.06}, 2000, 1e-8, 1, true, 0);
  for (std::size_t n = 6; n < box.kernel.modes.decay_rate.size(); ++n)
    box.kernel.modes.decay_rate[n] = 0.2 * box.kernel.modes.angular_frequency[n];
  return box;
}

PlacedBody at(const Vector3d& place, double turned = 0) {
  PlacedBody out;
  out.translation = place;
  out.rotation = Eigen::AngleAxisd(turned, Vector3d(1, 2, 0).normalized()).toRotationMatrix();
  return out;
}

Meeting over_floor(const Cloud& box, const std::vector<PlacedBody>& bodies) {
  return {.clouds = std::vector<const Cloud*>(bodies.size(), &box),
          .bodies = bodies,
          .friction = Friction{0.5, 0.5, 0},
          .gravity = {0, 0, -g},
          .floor = true};
}

std::unique_ptr<Stepper> stepper_of(const Meeting& scene) {
  return make_stepper(meet(scene), {.contact = {.scheme = Scheme::compliant},
                                    .rigid = {.rotation = Rotation::finite},
                                    .step = 1 / 44100.0,
                                    .block = 1});
}

double weight_on(const Stepper& stepper, const Model& model, std::size_t pair) {
  return stepper.force().segment(model.pairs[pair].first_point, model.pairs[pair].points).sum();
}

/// Of the poses, all places must be equal to the last bit.
bool same(const Pose& one, const Pose& two) {
  return one.position == two.position && one.attitude.coeffs() == two.attitude.coeffs();
}

/// A box lies on the floor while another one, far away, falls, bounces and comes to rest. It sleeps long
/// before, bears its weight, and the other one moves as if it were alone.
TEST(Sleep, of_a_body_lasts_whatever_others_do_elsewhere) {
  const Cloud box = damped();
  const Meeting both = over_floor(box, {at({0, 0, 0.03 + 1e-6}), at({1, 0, 0.3}, 0.4)}),
                alone = over_floor(box, {at({1, 0, 0.3}, 0.4)});
  const auto model = meet(both);
  const auto stepper = stepper_of(both), single = stepper_of(alone);
  while (stepper->time() < 0.2) ASSERT_EQ(stepper->step(), StepStatus::ok);
  const Pose asleep = stepper->poses()[0];
  const Energy start = stepper->modal()->energy();
  EXPECT_GT(start.residual, 0);
  EXPECT_EQ(asleep.velocity.norm() + asleep.spin.norm(), 0);
  int touching = 0, active = 0;
  while (stepper->time() < 0.45) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    ASSERT_TRUE(same(stepper->poses()[0], asleep));
    ASSERT_NEAR(weight_on(*stepper, *model, 0), box.mass * g, 1e-3 * box.mass * g);
    const bool touches = weight_on(*stepper, *model, 2) > 0;
    touching += touches ? 1 : 0;
    if (active == 0) active = stepper->active();
    ASSERT_GE(stepper->active(), active);
    ASSERT_GE(stepper->modal()->energy().residual, start.residual * (1 - 1e-9));
    for (std::size_t f = 0; f < model->friction.size(); ++f) {
      const int i = model->friction[f].point;
      if (i < model->pairs[0].points && stepper->end_force()(i) > 0) {
        ASSERT_EQ(stepper->slip().states()[f], ContactState::stick);
      }
    }
  }
  while (single->steps() < stepper->steps()) ASSERT_EQ(single->step(), StepStatus::ok);
  EXPECT_GT(touching, 100);
  EXPECT_GE(active, 4);
  // Bounces amplify round-off, by 1e5 in the 0.2 s that they last here.
  EXPECT_LT((stepper->poses()[1].position - single->poses()[0].position).norm(), 1e-11);
  EXPECT_LT((stepper->poses()[1].spin - single->poses()[0].spin).norm(), 1e-6);
  EXPECT_NEAR(stepper->modal()->energy().ledger(), start.ledger(), 1e-12 * box.mass * g * 0.3);
}

/// A box falls on one that sleeps. A push of 0 keeps the latter awake in a second run, in which the impact is
/// the same.
TEST(Sleep, ends_when_a_body_falls_on_the_one_that_sleeps) {
  const Cloud box = damped();
  const Meeting scene = over_floor(box, {at({0, 0, 0.03 + 1e-6}), at({0.03, 0.01, 0.3}, 0.4)});
  const auto sleeping = stepper_of(scene), waking = stepper_of(scene);
  int slept = 0;
  const Vector3d zero = Vector3d::Zero();
  for (const auto& stepper : {sleeping.get(), waking.get()})
    while (stepper->time() < 0.3) {
      if (stepper == waking.get() && stepper->steps() % 50 == 0) stepper->push(0, zero, zero);
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      slept += stepper == sleeping.get() && stepper->poses()[0].velocity.norm() == 0 ? 1 : 0;
    }
  EXPECT_GT(slept, 1000);
  for (std::size_t k = 0; k < 2; ++k) {
    const Pose &one = sleeping->poses()[k], &two = waking->poses()[k];
    EXPECT_GT(one.velocity.norm(), 1e-3);
    // The one that sleeps has lost speeds of up to 1e-6 m/s; the impact amplifies them.
    EXPECT_LT((one.position - two.position).norm(), 1e-7) << k;
    EXPECT_LT((one.velocity - two.velocity).norm(), 1e-5) << k;
  }
}

/// When the lower one of two boxes is pushed away, the upper one, which also sleeps, falls.
TEST(Sleep, ends_for_all_that_touch_the_one_that_is_pushed) {
  const Cloud box = damped();
  const Meeting scene =
      over_floor(box, {at({0, 0, 0.03 + 1e-6}), at({0, 0, 0.09 + 2e-6}), at({-1, 0, 0.03})});
  const auto stepper = stepper_of(scene);
  const auto speed = [&] {
    double out = 0;
    for (const Pose& pose : stepper->poses()) out += pose.velocity.norm() + pose.spin.norm();
    return out;
  };
  do {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    ASSERT_LT(stepper->time(), 1);
  } while (speed() > 0);
  const std::vector<Pose> before(stepper->poses().begin(), stepper->poses().end());
  const double start = stepper->time();
  stepper->push(0, {20 * box.mass * g, 0, 0}, Vector3d::Zero());
  while (stepper->time() < start + 0.2) ASSERT_EQ(stepper->step(), StepStatus::ok);
  EXPECT_GT(stepper->poses()[0].position.x(), before[0].position.x() + 0.1);
  EXPECT_LT(stepper->poses()[1].position.z(), 0.08);
  EXPECT_TRUE(same(stepper->poses()[2], before[2]));
}

}  // namespace sleeping_test
