// SPDX-License-Identifier: BSD-2-Clause
// States as bytes, from one simulation to an equal one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "tests/contact/cloud.hpp"
#include "tests/contact/plate.hpp"

namespace stored_state_test {

using namespace ricochet;
using contact::test::Cloud;
using contact::test::falling;
using contact::test::shared;
using ricochet::test::complaint_of;
using ::testing::AnyOf;
using ::testing::HasSubstr;

constexpr Friction rough{0.4, 0.3, 0.1};

SharedKernel box(unsigned seed = 3) {
  return shared(Cloud({0.1, 0.08, 0.06}, 2000, 1e-8, seed, true, 0.1).kernel);
}

/// Two boxes above each other over a floor that moves.
Scene two_boxes(Rotation rotation) {
  Scene scene;
  scene.rotation = rotation;
  scene.rate_hz = 20e3;
  scene.contact_rate_hz = 40e3;
  scene.gravity = {0, 0, -9.81};
  scene.obstacles = {{.name = "floor", .normal = {0, 0, 1}, .velocity = {0.1, 0, 0}}};
  scene.bodies = {{.name = "a", .kernel = box(), .translate = {0, 0, 0.035}, .velocity = {0.1, 0, -1}},
                  {.name = "b", .kernel = box(5), .translate = {0.01, 0, 0.105}, .velocity = {0, 0, -2}}};
  scene.pairs = {{.a = "a", .b = "floor", .friction = rough}, {.a = "b", .b = "a", .friction = rough}};
  scene.pickups = {{.body = "a", .candidate = 3, .direction = {0, 0, 1}},
                   {.body = "b", .candidate = 7, .direction = {1, 0, 0}}};
  return scene;
}

/// One scene for each scheme and each kind of stepper.
std::vector<std::pair<std::string, Scene>> scenes() {
  const Scene plate = falling({.modes = 30, .points = 40, .ratio = 0.01}, 1e-4, 1, 9.81);
  Scene single = plate, jump = plate, difference = plate, exact = plate, cut = plate;
  single.precision = Precision::float32;
  jump.scheme = difference.scheme = exact.scheme = Scheme::impulse;
  difference.admittance = Admittance::difference;
  exact.instant = Instant::exact;
  cut.max_pivots = 2;
  return {{"blocks", plate},
          {"blocks in single precision", single},
          {"limited pivots", cut},
          {"impulse", jump},
          {"difference", difference},
          {"events", exact},
          {"linear boxes with friction", two_boxes(Rotation::linear)},
          {"turning boxes with friction", two_boxes(Rotation::finite)}};
}

/// Makes steps, singly and in blocks. Returns all that can be read meanwhile.
std::vector<double> run(Simulation& simulation, int rounds) {
  std::vector<double> out;
  const auto add = [&](const auto& values) { out.insert(out.end(), values.begin(), values.end()); };
  for (int round = 0; round < rounds; ++round) {
    std::vector<double> velocity(11 * simulation.pickups()), total(11);
    EXPECT_EQ(simulation.step(), StepStatus::ok);
    EXPECT_EQ(simulation.step_block(11, {.velocity = velocity.data(), .total_force = total.data()}).status,
              StepStatus::ok);
    add(velocity);
    add(total);
    add(simulation.force());
    add(simulation.displacement());
    add(simulation.tangential_force());
    const Energy e = simulation.energy();
    add(std::vector{e.kinetic, e.strain, e.residual, e.loads, e.added, e.damping, e.contact, e.friction});
    for (const std::size_t body : simulation.bodies()) {
      const BodyMotion motion = simulation.body_motion(body);
      add(motion.position);
      add(motion.attitude);
      add(motion.velocity);
      add(motion.spin);
    }
  }
  return out;
}

void fall(Simulation& simulation) {
  for (int k = 0; k < 20'000 && simulation.active() == 0; ++k) ASSERT_EQ(simulation.step(), StepStatus::ok);
}

// The other simulation has been elsewhere, so that whatever a state leaves out differs.
TEST(StoredState, goes_on_in_another_simulation_to_the_last_bit) {
  for (const auto& [name, scene] : scenes()) {
    SCOPED_TRACE(name);
    Simulation simulation(scene);
    fall(simulation);
    if (scene.rotation == Rotation::finite) simulation.push(1, {0.1, 0, 0}, {0, 0.01, 0});
    for (const std::size_t candidate : {0, 2}) simulation.push_at(0, {.candidate = candidate}, {0, 0, -3});
    run(simulation, 3);
    const Simulation::State state = simulation.save();
    const std::vector<std::byte> bytes = state.bytes();
    const std::int64_t there = simulation.steps();
    const std::vector<double> then = run(simulation, 20);

    Simulation other(scene), third(scene);
    run(other, 20);
    ASSERT_TRUE(other.restore(other.state(bytes)));
    EXPECT_EQ(other.steps(), there);
    EXPECT_EQ(other.save().bytes(), bytes);
    EXPECT_EQ(run(other, 20), then);
    ASSERT_TRUE(third.restore(state));
    EXPECT_EQ(run(third, 20), then);
  }
}

TEST(StoredState, survives_the_simulation_that_saved_it) {
  const Scene scene = two_boxes(Rotation::finite);
  auto first = std::make_unique<Simulation>(scene);
  fall(*first);
  const Simulation::State state = first->save();
  const std::vector<double> then = run(*first, 5);
  first.reset();
  Simulation second(two_boxes(Rotation::finite));  // with kernels of its own
  ASSERT_TRUE(second.restore(state));
  EXPECT_EQ(run(second, 5), then);
}

TEST(StoredState, includes_the_state_of_bodies_that_were_added) {
  const SharedKernel kernel = box(7);
  const auto change = [&](Simulation& simulation, int between, double height) {
    simulation.add("c", kernel, {.position = {1, 0, 0.2}, .spin = {1, 2, 3}}, rough);
    simulation.step_block(between);
    simulation.remove(*simulation.find("c"));
    simulation.step_block(between);
    simulation.add("d", kernel, {.position = {1, 0, height}, .velocity = {0, 0, -1}}, rough);
  };
  const Scene scene = two_boxes(Rotation::finite);
  Simulation one(scene), other(scene);
  change(one, 200, 0.1);
  run(one, 20);
  const std::vector<std::byte> bytes = one.save().bytes();
  const std::vector<double> then = run(one, 20);
  EXPECT_THAT(complaint_of([&] { other.state(bytes); }), HasSubstr("of another system"));
  change(other, 3, 0.3);
  ASSERT_TRUE(other.restore(other.state(bytes)));
  EXPECT_EQ(run(other, 20), then);
}

TEST(StoredState, is_refused_if_it_is_damaged) {
  Simulation simulation(falling({}, 1e-4, 1, 9.81));
  fall(simulation);
  const std::vector<std::byte> bytes = simulation.save().bytes();
  const auto refused = [&](const std::vector<std::byte>& damaged) {
    return complaint_of([&] { simulation.state(damaged); });
  };
  for (std::size_t k = 0; k < bytes.size(); k += k < 64 || k + 64 > bytes.size() ? 1 : 37) {
    std::vector<std::byte> flipped = bytes;
    flipped[k] ^= std::byte(1 << (k % 8));
    EXPECT_THAT(refused(flipped), AnyOf("state: its bytes are damaged. Save it again.",
                                        "state: is not a saved state. Give the bytes of one."))
        << k;
  }
  for (std::size_t size = 0; size < bytes.size(); size += 101)
    EXPECT_THAT(refused({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)}),
                HasSubstr("state: "));
  EXPECT_NO_THROW(simulation.state(bytes));
}

/// Each measure of an obstacle that has a shape counts.
TEST(StoredState, is_refused_if_the_shape_of_an_obstacle_differs) {
  Scene scene = two_boxes(Rotation::finite);
  Obstacle& ring = scene.obstacles.emplace_back();
  ring.name = "ring";
  ring.shape = Shape::torus;
  ring.point = {3, 0, 0};
  ring.radius = 0.3;
  ring.radius_small = 0.1;
  const Simulation::State state = Simulation(scene).save();
  EXPECT_TRUE(Simulation(scene).restore(state));
  const std::vector<std::function<void(Obstacle&)>> changes{
      [](Obstacle& one) { one.point[0] = 3.1; },
      [](Obstacle& one) { one.rotate_deg[0] = 1; },
      [](Obstacle& one) { one.radius = 0.31; },
      [](Obstacle& one) { one.radius_small = 0.11; },
      [](Obstacle& one) { one.side = ObstacleSide::inside; },
      [](Obstacle& one) {
        one.shape = Shape::cone;
        one.length = 0.2;
      },
      [](Obstacle& one) {
        one.shape = Shape::box;
        one.size = {0.3, 0.2, 0.1};
      },
      [](Obstacle& one) {
        one.shape = Shape::mesh;
        one.mesh = {.node = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                    .triangle = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
      }};
  for (std::size_t k = 0; k < changes.size(); ++k) {
    Scene changed = scene;
    changes[k](changed.obstacles.back());
    EXPECT_FALSE(Simulation(changed).restore(state)) << k;
  }
}

TEST(StoredState, is_refused_by_another_system) {
  const Scene scene = two_boxes(Rotation::finite);
  const Simulation::State state = Simulation(scene).save();
  const std::vector<std::byte> bytes = state.bytes();
  const std::vector<std::function<void(Scene&)>> changes{
      [](Scene& s) { s.rate_hz = 20'001; },
      [](Scene& s) { s.contact_rate_hz = 60e3; },
      [](Scene& s) { s.integration = ContactStep::backward_euler; },
      [](Scene& s) { s.max_pivots = 7; },
      [](Scene& s) { s.rotation = Rotation::linear; },
      [](Scene& s) { s.gravity[2] = -9.8; },
      [](Scene& s) { s.bodies[0].name = s.pairs[0].a = s.pairs[1].b = s.pickups[0].body = "c"; },
      [](Scene& s) { s.bodies[0].translate[2] += 1e-9; },
      [](Scene& s) { s.bodies[1].velocity[2] *= -1; },
      [](Scene& s) { s.bodies[1].angular_velocity[0] = 1; },
      [](Scene& s) { s.bodies[0].kernel = box(4); },
      [](Scene& s) {
        kernels::Kernel kernel = *s.bodies[0].kernel;
        kernel.modes.decay_rate.back() += 1e-6;
        s.bodies[0].kernel = shared(kernel);
      },
      [](Scene& s) { s.obstacles[0].velocity[0] = 0.2; },
      [](Scene& s) { s.pairs[1].friction->dynamic_coefficient = 0.31; },
      [](Scene& s) { s.pairs.push_back({.a = "b", .b = "floor"}); }};
  for (std::size_t k = 0; k < changes.size(); ++k) {
    Scene changed = scene;
    changes[k](changed);
    Simulation other(changed);
    EXPECT_FALSE(other.restore(state)) << k;
    EXPECT_THAT(complaint_of([&] { other.state(bytes); }), HasSubstr("state: is of another system")) << k;
  }
  Scene heard = scene;
  heard.pickups.pop_back();
  heard.bodies[0].kernel = box();  // equal data
  Simulation same(heard);
  EXPECT_TRUE(same.restore(state));
}

}  // namespace stored_state_test
