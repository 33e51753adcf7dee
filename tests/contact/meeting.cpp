// SPDX-License-Identifier: BSD-2-Clause
// Bodies that turn by any angle and meet each other.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "contact/stepping/floating_stepper.hpp"
#include "tests/contact/cloud.hpp"
#include "tests/contact/heap_counter.hpp"
#include "tests/contact/meeting.hpp"
#include "tests/drawn.hpp"
#include "tests/support.hpp"

namespace ricochet::contact::test {
namespace {

/// Irregular bodies with modes, R, spins and friction, from few to many steps in a touch.
TEST(Meeting, keeps_the_balances) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> between(-1, 1);
  const auto any = [&] { return ricochet::test::drawn(between, random); };
  for (int round = 0; round < 12; ++round) {
    const double rate = 1e4 * std::pow(10.0, round % 3);
    std::vector<std::unique_ptr<Cloud>> clouds;
    Meeting scene;
    for (int k = 0; k < 3; ++k) {
      clouds.push_back(std::make_unique<Cloud>(Vector3d(0.1, 0.08, 0.06), 2000, round % 4 == 0 ? 0 : 1e-8,
                                               static_cast<unsigned>(10 * round + k)));
      scene.clouds.push_back(clouds.back().get());
      PlacedBody body;
      body.rotation = turn(3 * between(random), any());
      body.translation = Vector3d(0.15 * (k - 1), 0, 0) + 0.01 * any();
      body.velocity = Vector3d(-3.0 * (k - 1), 0, 0) + 0.3 * any();
      body.angular_velocity = 30 * any();
      scene.bodies.push_back(body);
    }
    if (round % 2) scene.friction = Friction{0.5, 0.5, 0};
    const auto model = meet(scene);
    auto stepper = make_stepper(model, stepping(rate));
    const Energy start = stepper->modal()->energy();
    const Vector3d p = momentum(scene, *stepper), L = angular_momentum(scene, *stepper);
    double highest = 0, drift = 0;
    const int steps = static_cast<int>(0.03 * rate);
    int touching = 0;
    for (int k = 0; k < steps; ++k) {
      ASSERT_EQ(stepper->step(), StepStatus::ok) << round << " " << k;
      const Energy now = stepper->modal()->energy();
      highest = std::max(highest, now.total() / start.total() - 1);
      drift = std::max(drift, std::abs(now.ledger() - start.ledger()) / start.total());
      touching += stepper->active() > 0;
    }
    ASSERT_GT(touching, 3) << round;
    // Tangents stay perpendicular to the normals while points pass from face to face.
    const RowFrames& frames = stepper->turning()->frames;
    for (const Model::FrictionPoint& point : model->friction) {
      Matrix3d rows;
      rows << frames.normal.row(point.point),
          frames.tangent.middleRows<2>(point.tangential - model->points());
      EXPECT_LT((rows * rows.transpose() - Matrix3d::Identity()).norm(), 1e-12) << round;
    }
    EXPECT_LT(highest, 1e-12) << round;  // contact never adds energy
    EXPECT_LT(drift, 1e-12) << round;
    EXPECT_LT((momentum(scene, *stepper) - p).norm(), 1e-13 * start.kinetic) << round;
    EXPECT_LT((angular_momentum(scene, *stepper) - L).norm(), 1e-12 * L.norm()) << round;
  }
}

PlacedBody at(const Vector3d& translation, const Matrix3d& rotation = Matrix3d::Identity(),
              const Vector3d& velocity = Vector3d::Zero()) {
  PlacedBody out;
  out.translation = translation;
  out.rotation = rotation;
  out.velocity = velocity;
  return out;
}

/// Two bars lie across each other, each on an edge. No candidate is where they meet.
TEST(Meeting, of_edges_is_where_they_cross) {
  const Cloud bar({0.1, 0.08, 0.06}, 2000, 1e-8, 1, true, 0);
  const Matrix3d on_edge = turn(std::numbers::pi / 4, {1, 0, 0});
  // Of the edge from the centre
  const double lowest = (0.04 + 0.03) / std::numbers::sqrt2, aside = (0.04 - 0.03) / std::numbers::sqrt2;
  struct Case {
    double distance;
    bool upwards;  // out of body a
    double sense;  // of the quarter turn between the bars, which reverses the order of nodes
  };
  for (const auto& [distance, upwards, sense] :
       {Case{58e-6, true, 1}, Case{10e-6, true, 1}, Case{58e-6, false, 1}, Case{58e-6, true, -1}}) {
    const Matrix3d across = turn(sense * std::numbers::pi / 2, {0, 0, 1}) * on_edge;
    Meeting scene{
        .clouds = {&bar, &bar},
        .bodies = {at({0, 0, 0}, on_edge), at({0.007, 0.003, 2 * lowest + distance}, across, {0, 0, -0.1})}};
    if (!upwards) std::ranges::reverse(scene.bodies);  // body a is the upper one
    auto stepper = make_stepper(meet(scene), stepping(176400));
    const double speed = 0.1;
    for (int k = 0; k < 2000 && stepper->active() == 0; ++k) ASSERT_EQ(stepper->step(), StepStatus::ok);
    ASSERT_GT(stepper->active(), 0);
    EXPECT_NEAR(speed * stepper->time(), distance, 1e-6);  // a step is 0.6 µm
    const Eigen::Index point =
        std::distance(stepper->force().begin(), std::ranges::max_element(stepper->force()));
    const RowFrames& frames = stepper->turning()->frames;
    EXPECT_NEAR(frames.normal(point, 2), upwards ? 1 : -1, 1e-12);
    // The lower edge leads along x, and the upper one along y.
    EXPECT_LT((frames.point_a.row(point) - Eigen::RowVector3d(0.007 + sense * aside, aside, lowest)).norm(),
              2e-6);
  }
}

/// The largest difference of the force on the first pair from that with linear rotations, as a share of its
/// peak; and the same of the velocity of the first body.
struct Distance {
  double force = 0, velocity = 0;
};

Distance from_linear(Meeting scene, int steps) {
  const auto turning = meet(scene);
  scene.turns = false;
  const auto fixed = meet(scene);
  auto finite = make_stepper(turning, stepping(1e5)),
       linear = make_stepper(fixed, stepping(1e5, Rotation::linear));
  double peak = 0, most = 0;
  for (int k = 0; k < steps; ++k) {
    EXPECT_EQ(finite->step(), StepStatus::ok);
    EXPECT_EQ(linear->step(), StepStatus::ok);
    const double force = linear->force().head(linear->points()).sum();
    peak = std::max(peak, force);
    most = std::max(most, std::abs(finite->force().head(finite->points()).sum() - force));
  }
  EXPECT_GT(peak, 10);
  const Energy energy = finite->modal()->energy();
  EXPECT_NEAR(energy.ledger(), initial_energy(*turning).ledger(), 1e-11 * energy.kinetic);
  for (std::size_t k = 0; k < scene.bodies.size(); ++k)
    if (turning->bodies[k].supported)
      EXPECT_EQ(finite->turning()->poses[k].position, Vector3d(turning->bodies[k].centre));
  return {most / peak, (finite->modal()->v.head<3>() - linear->modal()->v.head<3>()).norm() /
                           linear->modal()->v.head<3>().norm()};
}

/// With inertias that are too large to turn it, a box that falls on the face of a coarser one meets it as
/// with linear rotations, to the round-off of 60 and of 3000 steps. The other one is free, or springs hold
/// it.
TEST(Meeting, of_faces_without_a_turn_is_the_compliant_step) {
  Cloud small({0.02, 0.02, 0.02}, 2000, 1e-8, 1, true, 0), large({0.1, 0.08, 0.06}, 2000, 1e-8, 2, true, 0);
  for (Cloud* cloud : {&small, &large}) cloud->hold_attitude();
  const Distance free = from_linear(
      {.clouds = {&small, &large},
       .bodies = {at({0.011, 0.007, 0.04 + 1e-5}, Matrix3d::Identity(), {0, 0, -1}), at({0, 0, 0})}},
      60);
  EXPECT_LT(free.force, 1e-11);
  EXPECT_LT(free.velocity, 1e-11);
  large.support();
  const Distance held =
      from_linear({.clouds = {&small, &large},
                   .bodies = {at({0.011, 0.007, 0.04 + 1e-4}, Matrix3d::Identity(), {0, 0, -0.3}),
                              at({0, 0, 0}, turn(std::numbers::pi, {0, 0, 1}))},
                   .gravity = {0, 0, -9.81}},
                  3000);
  EXPECT_LT(held.force, 1e-10);
  EXPECT_LT(held.velocity, 1e-10);
}

/// Points follow a face over which they slide, while those of the linear scheme stay on its material. The
/// difference is about the way, 50 µm or less, over the spacing of the nodes, 30 mm, and falls with it.
TEST(Meeting, of_faces_that_slide_differs_from_the_linear_scheme_by_their_way) {
  Cloud small({0.02, 0.02, 0.02}, 2000, 1e-8, 1, true, 0), large({0.1, 0.08, 0.06}, 2000, 1e-8, 2, true, 0);
  for (Cloud* cloud : {&small, &large}) cloud->hold_attitude();
  const auto sliding = [&](double speed) {
    return from_linear({.clouds = {&small, &large},
                        .bodies = {at({0.011, 0.007, 0.04 + 1e-5}, Matrix3d::Identity(), {speed, 0, -1}),
                                   at({0, 0, 0})}},
                       60)
        .force;
  };
  const double slow = sliding(0.05), fast = sliding(0.2);
  EXPECT_GT(fast, 1e-5);
  EXPECT_LT(fast, 0.2 * 230e-6 / 0.03);
  EXPECT_NEAR(fast / slow, 4, 0.1);
}

/// Two boxes 10 mm apart, within their spheres, fly towards each other, face to face. Their flight is crossed
/// in samples until shortly before they touch, when the way is flown.
TEST(Meeting, of_boxes_is_awaited_in_jumps_of_samples) {
  const Cloud cloud({0.1, 0.08, 0.06}, 2000, 1e-8, 1, false, 0);
  const double way = 0.01, speed = 1, step = 1e-5;
  const Meeting scene{.clouds = {&cloud, &cloud},
                      .bodies = {at({0, 0, 0}), at({0.1 + way, 0, 0}, Matrix3d::Identity(), {-speed, 0, 0})}};
  auto stepper = make_stepper(meet(scene), stepping(1 / step, Rotation::finite, 50));
  int calls = 0;
  while (stepper->active() == 0 && calls < 2000) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    ++calls;
  }
  EXPECT_NEAR(stepper->time(), way / speed, 2 * step);
  EXPECT_LT(calls, 150) << "of 1000 steps";
}

/// A soft box with a finer mesh strikes another one. Which of them is body a exchanges all kinds of points.
TEST(Meeting, does_not_depend_on_the_order_of_the_bodies) {
  const Cloud small({0.02, 0.02, 0.02}, 100, 1e-8, 1, true, 0),
      large({0.1, 0.08, 0.06}, 150, 1e-8, 2, true, 0);
  const PlacedBody falls = at({0.011, 0.007, 0.05}, turn(0.6, {1, 2, 0.5}), {0.2, 0.1, -2}),
                   lies = at({0, 0, 0});
  Meeting one{.clouds = {&small, &large}, .bodies = {falls, lies}, .friction = Friction{0.3, 0.3, 0}};
  Meeting other{.clouds = {&large, &small}, .bodies = {lies, falls}, .friction = Friction{0.3, 0.3, 0}};
  auto first = make_stepper(meet(one), stepping(1e5)), second = make_stepper(meet(other), stepping(1e5));
  const auto sum = [](const Stepper& stepper) { return stepper.force().head(stepper.points()).sum(); };
  double peak = 0, most = 0;
  int touching = 0;
  for (int k = 0; k < 1200; ++k) {
    ASSERT_EQ(first->step(), StepStatus::ok);
    ASSERT_EQ(second->step(), StepStatus::ok);
    peak = std::max(peak, sum(*first));
    most = std::max(most, std::abs(sum(*first) - sum(*second)));
    touching += first->active() > 0;
  }
  EXPECT_GT(touching, 20);
  EXPECT_LT(most, 1e-6 * peak);  // round-off, which touches amplify
  EXPECT_LT((first->poses()[0].velocity - second->poses()[1].velocity).norm(), 1e-6);
}

/// A box that lies still is struck, and strikes the next one before the next search: it has the energy of the
/// first one, and not only its own.
TEST(Meeting, of_a_body_that_is_struck_with_the_next_one_is_found) {
  const Cloud box({0.1, 0.08, 0.06}, 2000, 1e-8, 1, true, 0);
  for (const double speed : {1.0, 5.0, 20.0})
    for (const double gap : {2e-5, 2e-4}) {
      Meeting scene{.clouds = {&box, &box, &box},
                    .bodies = {at({-0.1003, 0.003, 0.002}, Matrix3d::Identity(), {speed, 0, 0}),
                               at({0, 0, 0}), at({0.1 + gap, -0.004, 0.005})}};
      auto stepper = make_stepper(meet(scene), stepping(44100));
      for (int k = 0; k < 600; ++k) ASSERT_EQ(stepper->step(), StepStatus::ok);
      // Elastic boxes of one mass exchange most of their speeds, and none overtakes the next one.
      const auto velocity = [&](std::size_t k) { return stepper->poses()[k].velocity.x(); };
      EXPECT_GT(velocity(2), 0.4 * speed) << speed << " " << gap;
      EXPECT_LT(velocity(0), velocity(1)) << speed << " " << gap;
      EXPECT_LT(velocity(1), velocity(2)) << speed << " " << gap;
      EXPECT_LT(stepper->poses()[0].position.x() + 0.09, stepper->poses()[1].position.x());
      EXPECT_LT(stepper->poses()[1].position.x() + 0.09, stepper->poses()[2].position.x());
    }
}

/// A tower of three boxes of one size, whose corners lie on corners, comes to rest on a floor.
TEST(Meeting, of_a_tower_is_steady) {
  Cloud box({0.1, 0.08, 0.06}, 2000, 1e-8, 1, true, 0);
  for (double& x : box.kernel.modes.decay_rate) x = 1000;
  std::fill_n(box.kernel.modes.decay_rate.begin(), 6, 0.0);
  Meeting scene{.clouds = {&box, &box, &box},
                .bodies = {at({0, 0, 0.03 + 1e-5}), at({0, 0, 0.09 + 2e-5}), at({0, 0, 0.15 + 3e-5})},
                .friction = Friction{0.5, 0.5, 0},
                .gravity = {0, 0, -9.81},
                .floor = true};
  auto stepper = make_stepper(meet(scene), stepping(44100));
  int most = 0;
  for (int k = 0; k < 6000; ++k) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    most = std::max(most, stepper->active());
  }
  EXPECT_EQ(stepper->active(), 27);
  // Where corners lie on corners, one point touches and not two: they would be 41. A shift of less than 0.1
  // mm on the way may part some of them.
  EXPECT_LE(most, 30);
  for (std::size_t k = 0; k < 3; ++k) {
    const Pose& pose = stepper->poses()[k];
    EXPECT_LT((pose.position - Vector3d(0, 0, 0.03 + 0.06 * static_cast<double>(k))).norm(), 1e-5);
    EXPECT_LT(pose.spin.norm(), 1e-3);
  }
  double weight = 0;
  const auto model = meet(scene);
  const Model::PairBlock& lowest = model->pairs[0];
  for (int i = 0; i < lowest.points; ++i) weight += stepper->force()(lowest.first_point + i);
  EXPECT_NEAR(weight, 3 * box.mass * 9.81, 1e-3 * 3 * box.mass * 9.81);
}

/// A box slides over the edge of another one, on which it lies. Candidates of its lower face that have been
/// beyond the edge, and a little lower than it, do not run against it.
TEST(Meeting, of_a_face_that_slides_over_an_edge_is_smooth) {
  const Cloud box({0.1, 0.08, 0.06}, 2000, 1e-8, 1, true, 0);
  for (const double speed : {1.0, 5.0}) {  // in a step, by less and by more than what counts as the edge
    Meeting scene{.clouds = {&box, &box},
                  .bodies = {at({0, 0, 0.03}), at({0.051, 0.01, 0.09}, Matrix3d::Identity(), {-speed, 0, 0})},
                  .gravity = {0, 0, -9.81},
                  .floor = true};
    auto stepper = make_stepper(meet(scene), stepping(44100));
    int touching = 0;
    for (; stepper->time() * speed<5e-3; touching += stepper->active()> 0)
      ASSERT_EQ(stepper->step(), StepStatus::ok);
    EXPECT_GT(touching, 20);
    EXPECT_NEAR(stepper->poses()[1].velocity.x(), -speed, 1e-3);
    EXPECT_NEAR(stepper->poses()[0].velocity.x(), 0, 1e-3);
  }
}

TEST(Meeting, does_not_allocate) {
  if (!RICOCHET_HEAP_COUNTED) GTEST_SKIP();
  const Cloud one({0.1, 0.08, 0.06}, 2000, 1e-8, 1), other({0.1, 0.08, 0.06}, 2000, 1e-8, 2);
  Meeting scene{.clouds = {&one, &other},
                .bodies = {at({0, 0, 0}), at({0.05, 0.02, 0.12}, turn(0.4, {1, 2, 3}), {0, 0, -2})},
                .friction = Friction{0.5, 0.5, 0}};
  auto stepper = make_stepper(meet(scene), stepping(44100));
  int touching = 0;
  const long before = heap_counter::calls + heap_counter::returns;
  for (int k = 0; k < 2000; ++k) {
    stepper->step();
    touching += stepper->active() > 0;
  }
  EXPECT_EQ(heap_counter::calls + heap_counter::returns, before);
  EXPECT_GT(touching, 3);
}

// Bodies on a floor that do not meet are islands of their own, with matrices of their own.
TEST(Meeting, on_a_floor_alone_does_not_allocate) {
  if (!RICOCHET_HEAP_COUNTED) GTEST_SKIP();
  const Cloud one({0.1, 0.08, 0.06}, 2000, 1e-8, 1), other({0.1, 0.08, 0.06}, 2000, 1e-8, 2);
  Meeting scene{.clouds = {&one, &other},
                .bodies = {at({0, 0, 0.04}, turn(0, {0, 0, 1}), {0, 0, -0.5}),
                           at({0.5, 0, 0.04}, turn(0, {0, 0, 1}), {0, 0, -0.5})},
                .friction = Friction{0.5, 0.5, 0},
                .gravity = {0, 0, -1000},
                .floor = true};
  auto stepper = make_stepper(meet(scene), stepping(44100));
  int touching = 0;
  const long before = heap_counter::calls + heap_counter::returns;
  for (int k = 0; k < 2000; ++k) {
    stepper->step();
    touching += stepper->active() > 2;
  }
  EXPECT_EQ(heap_counter::calls + heap_counter::returns, before);
  EXPECT_GT(touching, 10);
}

}  // namespace
}  // namespace ricochet::contact::test
