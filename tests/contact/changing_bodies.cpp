// SPDX-License-Identifier: BSD-2-Clause
// Bodies that are added to a simulation and removed from it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <malloc.h>

#include <array>
#include <cmath>
#include <numbers>

#include "tests/contact/cloud.hpp"
#include "tests/contact/heap_counter.hpp"
#include "tests/contact/plate.hpp"
#include "tests/contact/rigid_body.hpp"

namespace changing_bodies_test {

using namespace ricochet;
using contact::test::Cloud;
using contact::test::shared;
using ricochet::test::complaint_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr double g = 9.81;
constexpr Friction rough{0.4, 0.4, 0};

/// An elastic box of 27 masses, 0.1 × 0.08 × 0.06 m.
SharedKernel box(double irregular = 0.1, unsigned seed = 3) {
  return shared(Cloud({0.1, 0.08, 0.06}, 2000, 1e-8, seed, true, irregular).kernel);
}

/// One with flat faces that stops ringing within some periods.
Cloud damped_box() {
  Cloud out({0.1, 0.08, 0.06}, 2000, 1e-8, 3, true, 0);
  for (std::size_t n = 6; n < out.kernel.modes.decay_rate.size(); ++n)
    out.kernel.modes.decay_rate[n] = 0.2 * out.kernel.modes.angular_frequency[n];
  return out;
}

/// Above a floor, with pairs between all. Named a, b, c, …
Scene scene_of(const std::vector<Body>& bodies, const std::optional<Friction>& friction = rough) {
  Scene scene;
  scene.rotation = Rotation::finite;
  scene.rate_hz = 20e3;
  scene.gravity = {0, 0, -g};
  scene.obstacles = {{.name = "floor", .normal = {0, 0, 1}}};
  for (const Body& body : bodies) {
    scene.bodies.push_back(body);
    scene.bodies.back().name = std::string(1, static_cast<char>('a' + scene.bodies.size() - 1));
  }
  for (const Body& one : scene.bodies) {
    for (const Body& other : scene.bodies)
      if (&other < &one) scene.pairs.push_back({.a = other.name, .b = one.name, .friction = friction});
    scene.pairs.push_back({.a = one.name, .b = "floor", .friction = friction});
  }
  return scene;
}

BodyMotion at(double x, double z, const Vector3& velocity = {0, 0, 0}, const Vector3& spin = {0, 0, 0}) {
  return {.position = {x, 0, z}, .velocity = velocity, .spin = spin};
}

/// 13 numbers of a motion.
std::vector<double> numbers(const BodyMotion& motion) {
  std::vector<double> out;
  for (const auto& part : {motion.position, motion.velocity, motion.spin})
    out.insert(out.end(), part.begin(), part.end());
  out.insert(out.end(), motion.attitude.begin(), motion.attitude.end());
  return out;
}

double largest_difference(const BodyMotion& one, const BodyMotion& other) {
  double out = 0;
  const auto a = numbers(one), b = numbers(other);
  for (std::size_t k = 0; k < a.size(); ++k) out = std::max(out, std::abs(a[k] - b[k]));
  return out;
}

std::vector<std::string> names(Simulation& simulation) {
  std::vector<std::string> out;
  for (const std::size_t body : simulation.bodies()) out.emplace_back(simulation.name(body));
  return out;
}

/// Steps until something touches.
void fall(Simulation& simulation) {
  for (int k = 0; k < 100'000 && simulation.active() == 0; ++k) ASSERT_EQ(simulation.step(), StepStatus::ok);
  ASSERT_GT(simulation.active(), 0);
}

/// Kinetic and strain energy of elastic modes [J].
std::array<double, 2> elastic_energy(const Simulation& simulation, std::size_t body,
                                     const SharedKernel& kernel) {
  std::vector<double> q(simulation.modes(body)), v(q.size());
  simulation.modal_coordinates(body, q.data(), v.data());
  std::array<double, 2> out{};
  for (std::size_t n = 0; n < q.size(); ++n) {
    out[0] += v[n] * v[n] / 2;
    out[1] += std::pow(kernel->modes.angular_frequency[n] * q[n], 2) / 2;
  }
  return out;
}

// A box that has hit a floor without friction. What its frame does not have of its energy is in its modes.
TEST(ChangingBodies, have_modal_coordinates_without_the_motion_of_their_frames) {
  const SharedKernel kernel = box(0);
  Simulation simulation(scene_of(
      {{.name = "", .kernel = kernel, .translate = {0, 0, 0.08}, .velocity = {0, 0, -1}}}, std::nullopt));
  EXPECT_EQ(simulation.modes(0), kernel->modes.size());
  EXPECT_EQ(simulation.modes(7), 0u);
  fall(simulation);
  while (simulation.active() > 0) ASSERT_EQ(simulation.step(), StepStatus::ok);
  for (int k = 0; k < 20; ++k) ASSERT_EQ(simulation.step(), StepStatus::ok);
  const auto [kinetic, strain] = elastic_energy(simulation, 0, kernel);
  const BodyMotion motion = simulation.body_motion(0);
  const auto [w, x, y, z] = motion.attitude;
  const Eigen::Vector3d velocity(motion.velocity.data()),
      spin = Eigen::Quaterniond(w, x, y, z).conjugate() * Eigen::Vector3d(motion.spin.data());
  const Eigen::Map<const Eigen::Matrix3d> inertia(kernel->inertia.data());
  const double rigid = (kernel->mass * velocity.squaredNorm() + spin.dot(inertia * spin)) / 2;
  const Energy energy = simulation.energy();
  EXPECT_GT(kinetic, 1e-3 * rigid);
  EXPECT_NEAR(kinetic, energy.kinetic - rigid, 1e-9 * rigid);
  EXPECT_NEAR(strain, energy.strain, 1e-9 * rigid);
}

// Calls follow the points from the first touch to the end, also after a body has been added.
TEST(ChangingBodies, are_reported_while_they_touch) {
  const SharedKernel kernel = box();
  Simulation simulation(
      scene_of({{.name = "", .kernel = kernel, .translate = {0, 0, 0.08}, .velocity = {0, 0, -1}}}));
  struct Calls {
    int with = 0, without = 0;
    double impulse = 0;
    bool goes_on = true;
  } calls;
  simulation.on_contact(
      [](void* user, std::span<const Touching> contacts) {
        Calls& count = *static_cast<Calls*>(user);
        ++(contacts.empty() ? count.without : count.with);
        for (const Touching& one : contacts) count.impulse -= one.force[2] / 20e3;
        return count.goes_on;
      },
      &calls);
  simulation.add("far", kernel, at(5, 5), rough);
  const double before = kernel->mass * simulation.mean_velocity(0)[2];
  int steps = 0;
  for (; calls.without == 0 && steps < 10'000; ++steps) ASSERT_EQ(simulation.step(), StepStatus::ok);
  EXPECT_GT(calls.with, 3);
  const double gained = kernel->mass * simulation.mean_velocity(0)[2] - before;
  EXPECT_NEAR(calls.impulse, gained + kernel->mass * g * steps / 20e3, 1e-9);

  calls = {.goes_on = false};
  simulation.add("low", kernel, at(2, 0.08, {0, 0, -1}), rough);
  const BlockResult ended = simulation.step_block(10'000);
  EXPECT_EQ(ended.status, StepStatus::ok);
  EXPECT_LT(ended.steps, 10'000);
  EXPECT_EQ(calls.with, 1);
  EXPECT_GT(simulation.contacts().size(), 0u);
}

// One body turns too fast for its strain to be that of a body at rest, and is removed.
TEST(ChangingBodies, keep_the_warnings_of_bodies_that_have_left) {
  const SharedKernel kernel = box();
  Simulation simulation(
      scene_of({{.name = "", .kernel = kernel, .translate = {0, 0, 9}, .velocity = {0, 0, 0}}}));
  simulation.watch({}, 1000);
  const std::size_t fast = simulation.add("fast", kernel, at(5, 9, {0, 0, 0}, {0, 0, 3000}), rough);
  simulation.step_block(50);
  const std::vector<std::string> seen = simulation.warnings();
  ASSERT_THAT(seen, Not(IsEmpty()));
  EXPECT_THAT(seen[0], HasSubstr("fast"));
  simulation.remove(fast);
  // Another one takes its place, with a name of its own.
  const std::size_t next = simulation.add("next", kernel, at(5, 9, {0, 0, 0}, {0, 0, 3000}), rough);
  simulation.step_block(50);
  const std::vector<std::string> both = simulation.warnings();
  ASSERT_EQ(both.size(), 2 * seen.size());
  EXPECT_EQ(both[0], seen[0]);
  EXPECT_THAT(both[seen.size()], HasSubstr("next"));
  simulation.remove(next);
  simulation.add("other", shared(Cloud({0.1, 0.08, 0.06}, 2000, 1e-8, 3, true, 0).kernel), at(3, 9), rough);
  simulation.step_block(50);
  EXPECT_EQ(simulation.warnings(), both);
}

// Two boxes hit each other and the floor, and a third one is far away.
TEST(ChangingBodies, go_on_to_the_last_bit_without_one_that_never_touched_anything) {
  const SharedKernel kernel = box();
  const Scene scene =
      scene_of({{.name = "", .kernel = kernel, .translate = {0, 0, 0.08}, .angular_velocity = {2, 1, 0}},
                {.name = "", .kernel = kernel, .translate = {0.03, 0, 0.2}, .velocity = {0, 0, -1}},
                {.name = "", .kernel = kernel, .translate = {3, 0, 30}, .angular_velocity = {0, 7, 0}}});
  Simulation whole(scene), less(scene);
  fall(whole);
  fall(less);
  less.remove(2);
  EXPECT_THAT(names(less), ElementsAre("a", "b"));
  int touched = 0;
  for (int k = 0; k < 4000; ++k) {
    ASSERT_EQ(whole.step(), StepStatus::ok);
    ASSERT_EQ(less.step(), StepStatus::ok);
    for (const std::size_t body : {0, 1})
      ASSERT_EQ(numbers(less.body_motion(body)), numbers(whole.body_motion(body))) << k;
    ASSERT_EQ(less.contacts().size(), whole.contacts().size()) << k;
    for (const Touching& one : less.contacts()) touched |= one.between[1] == "floor" ? 1 : 2;
  }
  EXPECT_EQ(touched, 3);  // both kinds of pairs touched
  EXPECT_EQ(less.time(), whole.time());
}

// The new body changes the rhythm of the searches, and the matrices are factored anew: to round-off, which
// contacts amplify.
TEST(ChangingBodies, go_on_as_before_beside_one_that_is_added_far_away) {
  const SharedKernel kernel = box();
  const Scene scene =
      scene_of({{.name = "", .kernel = kernel, .translate = {0, 0, 0.08}, .angular_velocity = {2, 1, 0}},
                {.name = "", .kernel = kernel, .translate = {0.03, 0, 0.2}, .velocity = {0, 0, -1}}});
  Simulation before(scene), more(scene);
  fall(before);
  fall(more);
  more.push(0, {0.1, 0, 0}, {0, 0, 1e-4});
  before.push(0, {0.1, 0, 0}, {0, 0, 1e-4});
  EXPECT_EQ(more.add("far", kernel, at(5, 30), rough), 2);
  ASSERT_EQ(more.find("far"), 2);
  EXPECT_EQ(more.force()[0], before.force()[0]);
  EXPECT_EQ(more.contacts().size(), before.contacts().size());
  EXPECT_EQ(more.active(), before.active());
  for (int k = 0; k < 400; ++k) {
    ASSERT_EQ(before.step(), StepStatus::ok);
    ASSERT_EQ(more.step(), StepStatus::ok);
    for (const std::size_t body : {0, 1})
      ASSERT_LT(largest_difference(more.body_motion(body), before.body_motion(body)), 1e-9) << k;
  }
  const double fallen = 400 / scene.rate_hz;
  EXPECT_NEAR(more.body_motion(2).position[2], 30 - g * fallen * fallen / 2, 1e-12);
}

// A body at a new place, and one at a place that was left, move as in a simulation that has them from the
// start. In flights, attitudes have errors of their own, so nothing else touches. 1e-9: round-off that
// contact amplifies.
TEST(ChangingBodies, bring_the_motion_of_a_simulation_that_begins_with_them) {
  const SharedKernel kernel = box();
  BodyMotion motion = at(0, 0.1, {0.3, 0, -1}, {3, 1, 2});
  motion.attitude = {std::cos(0.3), 0, std::sin(0.3), 0};
  Body placed{.name = "a", .kernel = kernel, .rotate_deg = {0, 0.6 * 180 / std::numbers::pi, 0}};
  placed.velocity = motion.velocity;
  placed.angular_velocity = motion.spin;
  const Vector3 centre = kernel->centre;
  const double c = std::cos(0.6), s = std::sin(0.6);
  placed.translate = {-(c * centre[0] + s * centre[2]), -centre[1], 0.1 - (c * centre[2] - s * centre[0])};
  for (const bool place_left : {false, true}) {
    Simulation alone(scene_of({placed}));
    Simulation late(scene_of({{.name = "", .kernel = kernel, .translate = {9, 0, 5}}}));
    late.step_block(1000);
    if (place_left) late.remove(late.add("gone", kernel, at(1, 1, {2, 0, 0}, {1, 2, 3}), rough));
    if (place_left) late.step_block(50);
    const std::size_t m = late.points().size();
    const std::size_t number = late.add("late", kernel, motion, rough);
    EXPECT_EQ(late.points().size() == m, place_left);
    EXPECT_LT(largest_difference(late.body_motion(number), alone.body_motion(0)), 1e-14);
    int touching = 0;
    for (int k = 0; k < 1000; ++k) {
      ASSERT_EQ(alone.step(), StepStatus::ok);
      ASSERT_EQ(late.step(), StepStatus::ok);
      ASSERT_LT(largest_difference(late.body_motion(number), alone.body_motion(0)), 1e-9) << k;
      touching += alone.active() > 0;
    }
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(late.mean_velocity(number)[axis], late.body_motion(number).velocity[axis], 1e-12);
    EXPECT_GT(touching, 5);
  }
}

// A body strikes another one from below, at the place of one that came from above: they do not pass through
// each other.
TEST(ChangingBodies, meet_where_those_before_them_did_not) {
  const SharedKernel kernel = box(0);
  Scene scene = scene_of({{.name = "", .kernel = kernel, .translate = {0, 0, 1}}});
  scene.gravity = {0, 0, 0};
  Simulation simulation(scene);
  const std::size_t above = simulation.add("above", kernel, at(0, 1.075, {0, 0, -1}), rough);
  while (simulation.active() == 0) ASSERT_EQ(simulation.step(), StepStatus::ok);
  EXPECT_NEAR(simulation.time(), 0.015, 1e-3);
  simulation.remove(above);
  const double height = simulation.body_motion(0).position[2];
  const std::size_t below = simulation.add("below", kernel, at(0, height - 0.075, {0, 0, 1}), rough);
  for (int k = 0; k < 600 && simulation.active() == 0; ++k) ASSERT_EQ(simulation.step(), StepStatus::ok);
  EXPECT_GT(simulation.active(), 0);
  simulation.step_block(1000);
  EXPECT_GT(simulation.body_motion(0).position[2] - simulation.body_motion(below).position[2], 0.0599);
}

// What lies on a body falls when it is removed: by ½gt², to the elastic energy that the support had stored.
TEST(ChangingBodies, fall_when_what_bore_them_is_removed) {
  const SharedKernel kernel = box(0);
  Simulation simulation(scene_of({{.name = "", .kernel = kernel, .translate = {0, 0, 0.03}},
                                  {.name = "", .kernel = kernel, .translate = {0, 0, 0.09}}},
                                 rough));
  simulation.step_block(2000);
  ASSERT_GT(simulation.active(), 4);
  ASSERT_GT(simulation.contacts().size(), 4);
  const double height = simulation.body_motion(1).position[2];
  simulation.remove(0);
  EXPECT_TRUE(simulation.contacts().empty());
  EXPECT_EQ(simulation.active(), 0);
  constexpr double t = 0.05;
  simulation.step_block(1000);
  EXPECT_NEAR(height - simulation.body_motion(1).position[2], g * t * t / 2, 1e-6);
  EXPECT_TRUE(std::isnan(simulation.body_motion(0).position[2]));
  EXPECT_TRUE(std::isnan(simulation.mean_velocity(0)[2]));
  simulation.step_block(20'000);
  EXPECT_NEAR(simulation.body_motion(1).position[2], 0.03, 1e-5);  // it lies on the floor
}

// Two damped boxes lie on each other until they sleep; their forces stay in all that a simulation gives. When
// the lower one is removed, the upper one wakes and falls. 1e-3: by which forces may still change at rest.
TEST(ChangingBodies, bear_their_weight_and_fall_also_when_they_sleep) {
  const Cloud cloud = damped_box();
  const double weight = cloud.mass * g;
  const SharedKernel kernel = shared(cloud.kernel);
  Simulation simulation(scene_of({{.name = "", .kernel = kernel, .translate = {0, 0, 0.03 + 1e-6}},
                                  {.name = "", .kernel = kernel, .translate = {0, 0, 0.09 + 2e-6}}}));
  const auto sleeps = [&](std::size_t body) {
    const BodyMotion now = simulation.body_motion(body);
    return now.velocity == Vector3{0, 0, 0} && now.spin == Vector3{0, 0, 0};
  };
  do {
    ASSERT_EQ(simulation.step(), StepStatus::ok);
  } while (simulation.steps() < 20'000 && !(sleeps(0) && sleeps(1)));
  ASSERT_TRUE(sleeps(0) && sleeps(1));
  simulation.step_block(10);
  double total = 0;
  EXPECT_EQ(simulation.step_block(1, {.total_force = &total}).steps, 1);
  EXPECT_NEAR(total, 3 * weight, 3e-3 * weight);  // of one box on the other, and of both on the floor
  double listed = 0, by_point = 0;
  for (const Touching& one : simulation.contacts())
    for (std::size_t axis = 0; axis < 3; ++axis) listed += one.force[axis] * one.normal[axis];
  for (const double force : simulation.force()) by_point += force;
  EXPECT_NEAR(listed, total, 1e-3 * weight);
  EXPECT_NEAR(by_point, total, 1e-9 * weight);
  const double height = simulation.body_motion(1).position[2];
  simulation.remove(0);
  simulation.step_block(1000);
  EXPECT_NEAR(height - simulation.body_motion(1).position[2], g * 0.05 * 0.05 / 2, 1e-6);
}

// Added at rest, at the place that another one left and at a new one, while a box presses on the floor that
// has lain there for a second.
TEST(ChangingBodies, fall_from_rest_however_long_others_have_rested) {
  const SharedKernel kernel = shared(damped_box().kernel);
  Simulation simulation(scene_of({{.name = "", .kernel = kernel, .translate = {0, 0, 0.03}},
                                  {.name = "", .kernel = kernel, .translate = {1, 0, 0.03}}}));
  simulation.step_block(1000);
  simulation.remove(1);
  simulation.push(0, {0, 0, -1}, {0, 0, 1e-9});  // the torque keeps it awake
  simulation.step_block(10'000);
  ASSERT_GT(simulation.active(), 0);
  for (const double x : {1.0, 2.0}) {
    const std::size_t body = simulation.add(x == 1 ? "again" : "new", kernel, at(x, 0.5), rough);
    simulation.step_block(1000);
    EXPECT_NEAR(0.5 - simulation.body_motion(body).position[2], g * 0.05 * 0.05 / 2, 1e-6);
  }
}

// What a body brings is its kinetic energy; what it takes away is that and its elastic one. The balance of
// the others stays closed, to round-off of the energies.
TEST(ChangingBodies, keep_the_ledger_closed) {
  const Cloud cloud({0.1, 0.08, 0.06}, 2000, 1e-8, 3, true, 0.1);
  const SharedKernel kernel = shared(cloud.kernel);
  Simulation simulation(
      scene_of({{.name = "", .kernel = kernel, .translate = {0, 0, 0.05}, .velocity = {1, 0, -1}}}));
  const double start = simulation.energy().ledger(), scale = simulation.energy().kinetic;
  const auto closed = [&] {
    const Energy now = simulation.energy();
    EXPECT_NEAR(now.ledger(), start, 1e-12 * scale);
    return now;
  };
  simulation.step_block(200);
  const Vector3 spin{3, -2, 5};
  const Eigen::Map<const Eigen::Vector3d> w(spin.data());
  const double brought = 0.5 * cloud.mass * 4 + 0.5 * w.dot(cloud.inertia * w);
  const Energy before = closed();
  const std::size_t number = simulation.add("b", kernel, at(0, 0.4, {0, 0, -2}, spin), rough);
  EXPECT_NEAR(closed().added, brought, 1e-12 * scale);
  EXPECT_NEAR(simulation.energy().kinetic - before.kinetic, brought, 1e-12 * scale);
  EXPECT_NEAR(simulation.energy().loads - before.loads, brought, 1e-12 * scale);
  simulation.step_block(600);  // it falls by 3.7 cm and more
  closed();
  while (simulation.active() == 0) ASSERT_EQ(simulation.step(), StepStatus::ok);
  const Energy with = closed();
  const double work = with.loads - with.added;  // of gravity on both
  simulation.remove(0);
  const Energy without = closed();
  EXPECT_NEAR(without.loads - without.added, work, 1e-12 * scale);
  EXPECT_LT(without.added, with.added);
  simulation.step_block(20'000);
  closed();
  simulation.remove(number);
  const Energy none = closed();
  EXPECT_EQ(none.kinetic, 0);
  EXPECT_EQ(none.strain, 0);
  EXPECT_EQ(none.residual, 0);
  // What was brought and not taken away again has become heat, or damage of contact, or came from gravity.
  EXPECT_NEAR(none.added + start + work - (none.contact + none.friction + none.damping), 0,
              simulation.energy().loads);
  simulation.add("c", kernel, at(0, 0.1), rough);
  simulation.step_block(4000);
  closed();
}

TEST(ChangingBodies, have_numbers_and_names_that_stay) {
  const SharedKernel kernel = box(), other = box(0.1, 5);
  Simulation simulation(scene_of({{.name = "", .kernel = kernel, .translate = {0, 0, 0.1}},
                                  {.name = "", .kernel = kernel, .translate = {1, 0, 0.1}}}));
  EXPECT_EQ(simulation.add("c", other, at(2, 0.1)), 2);  // with other pairs: a new place
  simulation.remove(0);
  EXPECT_EQ(simulation.add("d", kernel, at(3, 0.1), rough), 3);
  EXPECT_EQ(simulation.add("a", other, at(4, 0.1), rough), 4);  // the name is free again
  simulation.remove(2);
  EXPECT_THAT(simulation.bodies(), ElementsAre(1, 3, 4));
  EXPECT_THAT(names(simulation), ElementsAre("b", "d", "a"));
  EXPECT_EQ(simulation.find("a"), 4);
  EXPECT_EQ(simulation.find("c"), std::nullopt);
  EXPECT_EQ(simulation.name(2), "");
  for (const auto& [number, x] : {std::pair(1, 1.0), {3, 3.0}, {4, 4.0}})
    EXPECT_NEAR(simulation.body_motion(static_cast<std::size_t>(number)).position[0], x, 0.01);
  EXPECT_FALSE(simulation.push(2, {1, 0, 0}, {}));
  EXPECT_TRUE(simulation.push(3, {1, 0, 0}, {}));
  simulation.step_block(100);
  EXPECT_GT(simulation.body_motion(3).velocity[0], 1e-3);
  EXPECT_EQ(simulation.body_motion(4).velocity[0], 0);
  fall(simulation);
  for (const Touching& one : simulation.contacts()) {
    EXPECT_NE(simulation.find(one.between[0]), std::nullopt);
    EXPECT_EQ(one.between[1], "floor");
  }
}

TEST(ChangingBodies, refuse_a_mistake_in_one_line_and_change_nothing) {
  const SharedKernel kernel = box(0);
  const Scene scene = scene_of({{.name = "", .kernel = kernel, .translate = {0, 0, 0.1}}});
  Simulation simulation(scene), twin(scene);
  const auto refused = [&](const char* name, const BodyMotion& motion,
                           const std::optional<Friction>& friction = {}) {
    return complaint_of([&] { simulation.add(name, kernel, motion, friction); });
  };
  EXPECT_THAT(refused("a", at(1, 1)), HasSubstr("bodies.a: the name is taken"));
  EXPECT_THAT(refused("floor", at(1, 1)), HasSubstr("the name is taken"));
  EXPECT_THAT(refused("", at(1, 1)), HasSubstr("has no name"));
  // The boxes are 0.06 m high.
  EXPECT_THAT(refused("b", at(0.01, 0.15)),
              HasSubstr("contact between \"a\" and \"b\": they overlap by 0.01 m"));
  EXPECT_THAT(refused("b", at(1, 0.025)),
              HasSubstr("contact between \"b\" and \"floor\": they overlap by 0.005 m"));
  BodyMotion motion = at(1, 1);
  motion.attitude = {0, 0, 0, 0};
  EXPECT_THAT(refused("b", motion), HasSubstr("bodies.b.attitude = [0, 0, 0, 0]: is no rotation"));
  EXPECT_THAT(refused("b", at(1, NAN)), HasSubstr("bodies.b.position"));
  EXPECT_THAT(refused("b", at(1, 1, {}, {0, 0, 1e6})), HasSubstr("turns the body by"));
  EXPECT_THAT(refused("b", at(1, 1), Friction{-1, 0, 0}), HasSubstr("friction.static_coefficient = -1"));
  EXPECT_THAT(complaint_of([&] { simulation.add("b", nullptr, at(1, 1)); }),
              HasSubstr("bodies.b: has no kernel"));
  EXPECT_THAT(complaint_of([&] { simulation.add("b", contact::test::plate({}), at(1, 1)); }), HasSubstr("b"));
  EXPECT_THAT(complaint_of([&] { simulation.remove(7); }), HasSubstr("there is no body 7"));
  EXPECT_EQ(simulation.points().size(), twin.points().size());
  EXPECT_THAT(names(simulation), ElementsAre("a"));
  // The same at a place that another one has left.
  simulation.remove(simulation.add("b", kernel, at(1, 1)));
  EXPECT_THAT(refused("b", at(0.01, 0.15)), HasSubstr("they overlap by 0.01 m"));
  EXPECT_THAT(refused("b", at(1, 1, {}, {0, 0, 1e6})), HasSubstr("turns the body by"));
  // The round-off of modal displacements at rest, squared, times stiffnesses of up to 1e10.
  EXPECT_NEAR(simulation.energy().added, 0, 1e-20);

  Scene linear = scene;
  linear.rotation = Rotation::linear;
  Simulation small(linear);
  EXPECT_THAT(complaint_of([&] { small.add("b", kernel, at(1, 1)); }), HasSubstr("finite rotations only"));
  EXPECT_THAT(complaint_of([&] { small.remove(0); }), HasSubstr("finite rotations only"));
}

TEST(ChangingBodies, refuse_a_state_of_other_bodies) {
  const SharedKernel kernel = box();
  Simulation simulation(scene_of({{.name = "", .kernel = kernel, .translate = {0, 0, 0.1}}}));
  const Simulation::State one = simulation.save();
  const std::size_t number = simulation.add("b", kernel, at(1, 0.1), rough);
  EXPECT_FALSE(simulation.restore(one));
  const Simulation::State two = simulation.save();
  simulation.step_block(3000);
  const BodyMotion then = simulation.body_motion(number);
  EXPECT_TRUE(simulation.restore(two));
  simulation.step_block(3000);
  EXPECT_EQ(numbers(simulation.body_motion(number)), numbers(then));
  simulation.remove(number);
  EXPECT_FALSE(simulation.restore(two));
  const Simulation::State three = simulation.save();
  simulation.add("b", kernel, at(1, 0.1), rough);  // at the same place
  EXPECT_FALSE(simulation.restore(two));
  EXPECT_FALSE(simulation.restore(three));
}

// Steps after a change allocate nothing, and a body that takes a place which another one has left needs no
// memory that stays.
TEST(ChangingBodies, need_no_memory_for_places_that_were_left) {
  const SharedKernel kernel = box(), other = box(0.1, 5);
  Simulation simulation(scene_of({{.name = "", .kernel = kernel, .translate = {0, 0, 0.1}}}));
  std::size_t number = simulation.add("jet", kernel, at(0, 0.3), rough);
  const auto cycle = [&](const SharedKernel& of) {
    simulation.remove(number);
    number = simulation.add("jet", of, at(0, 0.3, {0.1, 0, -1}), rough);
    const long before = heap_counter::calls;
    EXPECT_EQ(simulation.step_block(20).status, StepStatus::ok);
    EXPECT_EQ(heap_counter::calls, before);
  };
  const auto held = [] { return heap_counter::calls - heap_counter::returns; };
  for (int k = 0; k < 10; ++k) cycle(kernel);
  const long before = held();
  for (int k = 0; k < 1000; ++k) cycle(kernel);
  EXPECT_EQ(held(), before);
  EXPECT_EQ(number, 1011);
  // With another kernel each time, the places are made anew.
  const auto in_use = [] {
    const struct mallinfo2 heap = mallinfo2();
    return heap.uordblks + heap.hblkhd;
  };
  for (int k = 0; k < 4; ++k) cycle(k % 2 ? kernel : other);
  const std::size_t used = in_use(), points = simulation.points().size();
  for (int k = 0; k < 20; ++k) cycle(k % 2 ? kernel : other);
  EXPECT_EQ(simulation.points().size(), points);
  // The allocator's caches hold some 20 kB more or less. Twenty places that stay would hold twenty times
  // this:
  const std::size_t after = in_use();
  simulation.add("third", kernel, at(1, 0.3), rough);
  const std::size_t place = in_use() - after;
  EXPECT_GT(place, 200'000);
  EXPECT_NEAR(static_cast<double>(after), static_cast<double>(used), static_cast<double>(place));
}

// A body with supports, which leaves no place, and one with a load. What lay on it falls.
TEST(ChangingBodies, can_be_supported_and_loaded) {
  Cloud held({0.1, 0.08, 0.06}, 2000, 1e-8, 3, true, 0);
  held.support();
  const SharedKernel table = shared(held.kernel), kernel = box(0);
  Scene scene = scene_of({{.name = "", .kernel = table, .translate = {0, 0, 0.5}},
                          {.name = "", .kernel = kernel, .translate = {0, 0, 0.561}}});
  Simulation simulation(scene);
  fall(simulation);
  const std::size_t second = simulation.add("second", table, at(1, 0.5), rough);
  const std::size_t guest = simulation.add("guest", kernel, at(1, 0.561), rough);
  simulation.step_block(4000);
  EXPECT_NEAR(simulation.body_motion(1).position[2], 0.56, 1e-4);
  EXPECT_NEAR(simulation.body_motion(guest).position[2], 0.56, 1e-4);
  EXPECT_EQ(simulation.body_motion(second).position, (Vector3{1, 0, 0.5}));
  simulation.remove(0);
  EXPECT_THAT(names(simulation), ElementsAre("b", "second", "guest"));
  simulation.step_block(1000);
  EXPECT_LT(simulation.body_motion(1).position[2], 0.56 - 0.9 * g * 0.05 * 0.05 / 2);
  EXPECT_NEAR(simulation.body_motion(guest).position[2], 0.56, 1e-4);
  simulation.remove(second);
  simulation.remove(1);
  simulation.remove(guest);
  EXPECT_TRUE(simulation.bodies().empty());
  EXPECT_EQ(simulation.step_block(10).status, StepStatus::ok);
  simulation.add("again", kernel, at(0, 0.1), rough);
  fall(simulation);
}

TEST(ChangingBodies, silence_the_pickups_of_one_that_is_removed) {
  const SharedKernel kernel = box();
  Scene scene = scene_of({{.name = "", .kernel = kernel, .translate = {0, 0, 0.1}, .velocity = {1, 0, 0}},
                          {.name = "", .kernel = kernel, .translate = {1, 0, 0.1}, .velocity = {2, 0, 0}}});
  scene.pickups = {{.body = "a", .direction = {1, 0, 0}}, {.body = "b", .direction = {1, 0, 0}}};
  Simulation simulation(scene);
  simulation.step_block(10);
  simulation.remove(0);
  std::vector<double> heard(2);
  const auto hear = [&] {
    simulation.step_block(1, {.velocity = heard.data()});
    EXPECT_EQ(heard[0], simulation.pickup_velocity(0));
    return heard;
  };
  EXPECT_EQ(hear()[0], 0);
  EXPECT_NEAR(hear()[1], 2, 1e-9);
  EXPECT_EQ(simulation.pickup_displacement(0), 0);
  simulation.add("c", kernel, at(0, 0.1, {3, 0, 0}), rough);  // at its place
  EXPECT_EQ(hear()[0], 0);
  simulation.add("d", kernel, at(2, 0.1, {3, 0, 0}), rough);  // at a new one
  EXPECT_EQ(hear()[0], 0);
  EXPECT_NEAR(hear()[1], 2, 1e-9);
}

// 2800 points with friction lie on the floor at once, three rows each.
TEST(ChangingBodies, and_steps_say_when_more_points_touch_than_a_step_can_hold) {
  kernels::Kernel kernel = contact::test::rigid_body(1, {1, 1, 1}, {Eigen::Vector3d::Zero()}, 0);
  kernel.surface = contact::test::sheet(55, 49, [](double s, double t) {
                     return std::pair(Eigen::Vector3d(t, s, 0), Eigen::Vector3d(0, 0, -1));
                   }).surface;
  for (std::size_t i = 0; i < kernel.surface.size(); ++i) {
    const Eigen::Map<const Eigen::Vector3d> x(&kernel.surface.node[3 * i]);
    for (int axis = 0; axis < 3; ++axis)
      for (int n = 0; n < 6; ++n)
        kernel.surface.shape.push_back(n < 3 ? (n == axis) : Eigen::Vector3d::Unit(n - 3).cross(x)(axis));
  }
  Simulation simulation(scene_of({{.name = "", .kernel = shared(std::move(kernel))}}));
  EXPECT_EQ(simulation.step(), StepStatus::crowded);
  EXPECT_EQ(simulation.steps(), 0);
}

}  // namespace changing_bodies_test
