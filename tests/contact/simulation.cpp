// SPDX-License-Identifier: BSD-2-Clause
// The library interface, as other programs use it.
#include "ricochet/ricochet.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "kernels/algebra.hpp"
#include "tests/contact/heap_counter.hpp"
#include "tests/contact/plate.hpp"
#include "tests/contact/rigid_plate.hpp"

namespace simulation_test {

using namespace ricochet;
using contact::test::falling;
using contact::test::plate;
using contact::test::shared;
using ricochet::test::complaint_of;

constexpr double length = 10;

/// A rod with ρA = EA = 1, so c = 1 and its impedance is 1. It moves along −`normal` at unit speed and
/// touches a wall at t = 0. `rotate_deg` must align its axis with `normal`.
Scene rod_at_wall(const Vector3& rotate_deg = {0, 0, 0}, const Vector3& normal = {1, 0, 0}) {
  Scene scene;
  Vector3 velocity = normal;
  for (double& x : velocity) x = -x;
  scene.bodies = {{.name = "rod",
                   .kernel = shared(contact::test::rod(100, length)),
                   .rotate_deg = rotate_deg,
                   .velocity = velocity}};
  scene.obstacles = {{.name = "wall", .normal = normal}};
  scene.pairs = {{.a = "rod", .b = "wall", .gap = 0.0}};
  scene.pickups = {{.body = "rod", .candidate = 1, .direction = normal}};
  scene.rate_hz = 100;
  return scene;
}

double mean(const std::vector<double>& values, double from, double to) {
  const auto at = [&](double t) { return values.begin() + static_cast<std::ptrdiff_t>(100 * t); };
  return std::accumulate(at(from), at(to), 0.0) / (100 * (to - from));
}

// Two hundred contact steps per sample: the force of a sample is their mean, so its impulse is that of the
// bodies. Blocks equal steps. 1e-12: round-off of the sums.
TEST(Simulation, makes_contact_steps_at_a_rate_of_their_own) {
  Scene scene = rod_at_wall();
  scene.pairs[0].gap = 0.3;
  scene.rate_hz = 10;
  scene.contact_rate_hz = 1999;
  Simulation by_block(scene), by_step(scene);
  std::vector<double> far_end(300), force(300);
  const BlockResult done =
      by_block.step_block(300, {.velocity = far_end.data(), .total_force = force.data()});
  EXPECT_EQ(done.steps, 300);
  EXPECT_NEAR(by_block.time(), 30, 1e-12);
  double impulse = 0;
  for (std::size_t k = 0; k < 300; ++k) {
    ASSERT_EQ(by_step.step(), StepStatus::ok);
    EXPECT_EQ(by_step.steps(), static_cast<std::int64_t>(k + 1));
    EXPECT_EQ(by_step.force()[0], force[k]) << k;
    EXPECT_EQ(by_step.pickup_velocity(0), far_end[k]) << k;
    impulse += force[k] / 10;
  }
  EXPECT_NEAR(impulse, 10 * (1 + by_step.mean_velocity(0)[0]), 1e-12);
  EXPECT_NEAR(by_step.mean_velocity(0)[0], 1, 2e-3);
  EXPECT_EQ(by_step.points()[0].normal, (Vector3{-1, 0, 0}));
  EXPECT_EQ(force[1], 0);  // the gap of 0.3 closes at 0.3 s
  EXPECT_GT(force[3], 0.5);
}

// 1e-10: round-off of a thousand steps in contact.
TEST(Simulation, is_the_same_for_bodies_turned_with_their_surroundings) {
  Simulation along_x(rod_at_wall());
  Simulation along_y(rod_at_wall({0, 0, 90}, {0, 1, 0}));
  Simulation askew(rod_at_wall({0, 0, 30}, {std::sqrt(3) / 2, 0.5, 0}));
  for (Simulation* turned : {&along_y, &askew}) {
    Simulation reference(rod_at_wall());
    for (int k = 0; k < 1000; ++k) {
      ASSERT_EQ(reference.step(), StepStatus::ok);
      ASSERT_EQ(turned->step(), StepStatus::ok);
      ASSERT_NEAR(reference.force()[0], turned->force()[0], 1e-10);
      ASSERT_NEAR(reference.pickup_velocity(0), turned->pickup_velocity(0), 1e-10);
    }
  }
}

// A plate with three rows of candidates 0.5 m apart, tilted by 10° about their direction: the second row is
// 0.5 sin 10° = 0.087 m higher than the first one.
TEST(Simulation, has_the_points_of_its_zone) {
  kernels::Kernel plate = contact::test::rigid_plate();
  plate.body = "plate";
  Scene scene;
  scene.bodies = {
      {.name = "plate", .kernel = shared(plate), .rotate_deg = {0, 10, 0}, .translate = {0, 0, 1}}};
  scene.obstacles = {{.name = "floor", .normal = {0, 0, 1}}};
  scene.pairs = {{.a = "plate", .b = "floor"}};
  EXPECT_EQ(Simulation(scene).points().size(), 9);
  scene.pairs[0].zone = 0.08;
  EXPECT_EQ(Simulation(scene).points().size(), 3);
  scene.pairs[0].zone = 0.1;
  EXPECT_EQ(Simulation(scene).points().size(), 6);
}

TEST(Simulation, falls_as_galilei_has_it) {
  Simulation simulation(falling({.modes = 1}, 1, 0, 9.81));
  simulation.step_block(4410);
  EXPECT_NEAR(simulation.time(), 0.1, 1e-15);
  EXPECT_NEAR(simulation.pickup_displacement(0), -0.5 * 9.81 * 0.01, 1e-12);
  EXPECT_NEAR(simulation.pickup_velocity(0), -0.981, 1e-12);
  EXPECT_NEAR(simulation.mean_velocity(0)[2], -0.981, 1e-12);
  EXPECT_NEAR(simulation.displacement()[2], 0.5 * 9.81 * 0.01, 1e-12);
  EXPECT_NEAR(simulation.energy().loads, 2 * 9.81 * 0.5 * 9.81 * 0.01, 1e-12);
  EXPECT_NEAR(simulation.energy().total(), 0, 1e-12);
}

TEST(Simulation, hears_the_receivers_of_a_kernel) {
  kernels::Kernel kernel = *plate({.modes = 1});
  kernel.receivers.resize(1);
  kernel.receivers[0].name = "mic";
  kernel.receivers[0].shape = {0, 0, 3 / std::sqrt(2.0)};  // three times the rigid motion
  Scene scene = falling({}, 1, 0.5, 0);
  scene.bodies[0].kernel = std::make_shared<const kernels::Kernel>(kernel);
  scene.pickups = {{.body = "plate", .receiver = "mic", .direction = {0, 0, -7}},
                   {.body = "plate", .candidate = 2, .direction = {0, 0, -1}}};
  Simulation simulation(scene);
  std::vector<double> heard(4);
  simulation.step_block(2, {.velocity = heard.data()});
  for (const std::size_t step : {0, 1}) {
    EXPECT_NEAR(heard[2 * step], 1.5, 1e-14);
    EXPECT_NEAR(heard[2 * step + 1], 0.5, 1e-14);
  }
}

/// A bar with its foot at x = 0 (tests/contact/bodies.hpp), far from a wall.
Scene bar_far_from_wall(int modes, double decay) {
  kernels::Kernel kernel = contact::test::clamped_bar(modes, length);
  kernel.modes.decay_rate.assign(static_cast<std::size_t>(modes), decay);
  Scene scene;
  scene.bodies = {{.name = "bar", .kernel = shared(std::move(kernel))}};
  scene.obstacles = {{.name = "wall", .point = {20 * length, 0, 0}, .normal = {-1, 0, 0}}};
  scene.pairs = {{.a = "bar", .b = "wall"}};
  scene.pickups = {{.body = "bar", .candidate = 1, .direction = {1, 0, 0}}};
  scene.rate_hz = 10;
  return scene;
}

// A force F at the tip stretches the bar by F L/(E A): from the start if it is a dead load, and once the bar
// has come to rest if it grows. 1e-9: e^(−0.15 · 200).
TEST(Simulation, stretches_a_bar_by_its_load) {
  Scene scene = bar_far_from_wall(20, 0.15);
  scene.forcing = {{.body = "bar", .name = "tip", .vector = {2, 0, 0}}};
  Simulation dead(scene);
  EXPECT_NEAR(dead.displacement()[0], 2 * length, 1e-12);
  ASSERT_EQ(dead.step_block(500).status, StepStatus::ok);
  EXPECT_NEAR(dead.displacement()[0], 2 * length, 1e-12);
  EXPECT_NEAR(dead.pickup_velocity(0), 0, 1e-12);
  scene.forcing[0].time = {0, 30, 31.7};
  scene.forcing[0].factor = {0, 0.5, 1};
  Simulation growing(scene);
  EXPECT_EQ(growing.displacement()[0], 0);
  ASSERT_EQ(growing.step_block(3000).status, StepStatus::ok);
  EXPECT_NEAR(growing.displacement()[0], 2 * length, 1e-9);
  EXPECT_NEAR(growing.energy().ledger(), 0, 1e-10);                        // with the loss to damping
  scene.forcing = {{"bar", "foot", true, {0.3, 0, 0}, {-2, -1}, {0, 1}}};  // displaced from the start
  Simulation displaced(scene);
  ASSERT_EQ(displaced.step_block(10).status, StepStatus::ok);
  EXPECT_NEAR(displaced.displacement()[0], 0.3, 1e-12);
}

// It is at the wall at t = 5, and its force there is 1.
TEST(Simulation, lets_a_body_arrive_at_its_time) {
  Scene scene = rod_at_wall();
  scene.bodies[0].arrival = 5;
  Simulation simulation(scene);
  std::vector<double> force(2000);
  ASSERT_EQ(simulation.step_block(2000, {.total_force = force.data()}).status, StepStatus::ok);
  EXPECT_EQ(*std::max_element(force.begin(), force.begin() + 499), 0);
  EXPECT_NEAR(mean(force, 5, 19), 1, 0.01);
}

/// The compliant scheme and the impulse scheme with both admittances.
std::vector<Scene> schemes(const Scene& compliant) {
  Scene jump = compliant, difference = compliant;
  jump.scheme = difference.scheme = Scheme::impulse;
  difference.admittance = Admittance::difference;
  return {compliant, jump, difference};
}

TEST(Simulation, block_is_its_steps_to_the_last_bit) {
  for (const Scene& scene : schemes(falling({.ratio = 0.01}, 1e-4, 1, 9.81))) {
    Simulation whole(scene), single(scene);
    constexpr std::size_t n = 3000, m = 3;
    std::vector<double> velocity(n), total(n), force(n * m), displacement(n * m);
    const BlockResult done =
        whole.step_block(n, {velocity.data(), total.data(), force.data(), displacement.data()});
    ASSERT_EQ(done.steps, n);
    int touching = 0;
    for (std::size_t k = 0; k < n; ++k) {
      ASSERT_EQ(single.step(), StepStatus::ok);
      ASSERT_EQ(velocity[k], single.pickup_velocity(0));
      double sum = 0;
      for (std::size_t i = 0; i < m; ++i) {
        ASSERT_EQ(force[k * m + i], single.force()[i]);
        ASSERT_EQ(displacement[k * m + i], single.displacement()[i]);
        sum += single.force()[i];
      }
      ASSERT_NEAR(total[k], sum, 1e-13 * sum);
      touching += single.active() > 0;
    }
    EXPECT_GT(touching, 20);
  }
}

// Blocks whose length is no multiple of the stepper's own blocks, with and without
// displacements, alternate with single steps.
TEST(Simulation, gives_the_same_whichever_way_steps_are_asked_for) {
  for (const Scene& scene : schemes(falling({.ratio = 0.01}, 1e-4, 1, 9.81))) {
    Simulation mixed(scene), single(scene);
    constexpr std::size_t n = 21, m = 3;
    std::vector<double> velocity(n), force(n * m), displacement(n * m);
    int touching = 0;
    for (int round = 0; round < 100; ++round) {
      const bool all = round % 3 == 0;
      const BlockResult done = mixed.step_block(n, {.velocity = velocity.data(),
                                                    .force = force.data(),
                                                    .displacement = all ? displacement.data() : nullptr});
      ASSERT_EQ(done.steps, n);
      for (std::size_t k = 0; k < n; ++k) {
        ASSERT_EQ(single.step(), StepStatus::ok);
        ASSERT_EQ(velocity[k], single.pickup_velocity(0)) << round << ' ' << k;
        for (std::size_t i = 0; i < m; ++i) {
          ASSERT_EQ(force[k * m + i], single.force()[i]);
          if (all) {
            ASSERT_EQ(displacement[k * m + i], single.displacement()[i]);
          }
        }
        touching += single.active() > 0;
      }
      for (int k = 0; k < 5; ++k) {
        ASSERT_EQ(mixed.step(), StepStatus::ok);
        ASSERT_EQ(single.step(), StepStatus::ok);
      }
      ASSERT_EQ(mixed.pickup_displacement(0), single.pickup_displacement(0));
      ASSERT_EQ(mixed.mean_velocity(0)[2], single.mean_velocity(0)[2]);
      // Sums over several steps are rounded in a different order.
      ASSERT_NEAR(mixed.energy().ledger(), single.energy().ledger(), 1e-12);
      ASSERT_NEAR(mixed.energy().contact, single.energy().contact, 1e-12);
    }
    EXPECT_GT(touching, 20);
  }
}

TEST(Simulation, goes_on_from_a_saved_state_to_the_last_bit_and_takes_no_memory_to_return) {
  for (const Scene& scene : schemes(falling({.ratio = 0.01}, 1e-4, 1, 9.81))) {
    Simulation simulation(scene);
    while (simulation.active() == 0) ASSERT_EQ(simulation.step(), StepStatus::ok);
    const Simulation::State touching = simulation.save();
    const std::int64_t there = simulation.steps();
    const auto run_on = [&] {
      std::vector<double> out(2000);
      simulation.step_block(2000, {.velocity = out.data()});
      const Energy e = simulation.energy();
      out.insert(out.end(), {e.kinetic, e.strain, e.residual, e.loads, e.damping, e.contact});
      return out;
    };
    const std::vector<double> first = run_on();
    const long before = heap_counter::calls;
    const bool restored = simulation.restore(touching);
    const long after = heap_counter::calls;
    EXPECT_TRUE(restored);
    EXPECT_EQ(after, before);
    EXPECT_EQ(simulation.steps(), there);
    EXPECT_GT(simulation.active(), 0);
    EXPECT_EQ(run_on(), first);

    Simulation twin(scene);
    EXPECT_TRUE(twin.restore(touching));
    EXPECT_EQ(twin.steps(), there);
    Simulation moved = std::move(simulation);
    EXPECT_TRUE(moved.restore(touching));
  }
}

TEST(Simulation, fills_the_rest_of_a_block_with_silence_when_a_step_fails) {
  Simulation simulation(falling({}, 1, 1e200, 0));  // its energy exceeds the range of double precision
  std::vector<double> velocity(5, 7), force(15, 7), tangential(45, 7);
  const BlockResult done = simulation.step_block(
      5, {.velocity = velocity.data(), .force = force.data(), .tangential_force = tangential.data()});
  EXPECT_EQ(done.status, StepStatus::not_finite);
  EXPECT_EQ(done.steps, 0);
  EXPECT_EQ(simulation.steps(), 0);
  EXPECT_EQ(velocity, std::vector<double>(5, 0));
  EXPECT_EQ(force, std::vector<double>(15, 0));
  EXPECT_EQ(tangential, std::vector<double>(45, 0));
}

constexpr double gravity = 9.81, weight = gravity;  // of the rigid plate, whose mass is 1

/// A rigid plate of 1 kg that lies on a floor and slides along it. Each of its 9 points is a spring.
Scene sliding(const Vector3& velocity, const std::optional<Friction>& friction, const Vector3& belt = {}) {
  Scene scene;
  scene.bodies = {
      {.name = "plate", .kernel = shared(contact::test::rigid_plate_on_springs(1e-6)), .velocity = velocity}};
  scene.obstacles = {{.name = "floor", .normal = {0, 0, 1}, .velocity = belt}};
  scene.pairs = {{.a = "plate", .b = "floor", .gap = 0.0, .friction = friction}};
  scene.pickups = {{.body = "plate", .direction = {1, 0, 0}}};
  scene.gravity = {0, 0, -gravity};
  return scene;
}

constexpr Friction rough{0.3, 0.3, 0};

double mean_velocity_after(const Scene& scene, double time, std::size_t k) {
  Simulation simulation(scene);
  const auto steps = static_cast<std::int64_t>(time * scene.rate_hz);
  EXPECT_EQ(simulation.step_block(steps).steps, steps);
  return simulation.mean_velocity(0)[k];
}

// The nine springs bounce with ω = √(9/(1e-6 · 1)) = 3000 rad/s, as the plate is laid on them at once. The
// force so oscillates by its mean, and the speed by μ g/ω = 1e-3 m/s; half a step and rounding are below
// that.
constexpr double bounce = 0.3 * gravity / 3000;

// A floor that moves at 0.8 m/s for a while and then rests: μ g speeds the plate up, and slows it down as
// long.
TEST(Friction, of_a_floor_that_starts_and_stops_does_the_same_to_a_plate) {
  const double half = 0.6 / (0.3 * gravity);
  Scene scene = sliding({}, rough);
  scene.obstacles[0].slides = {{{0.8 * half, 0, 0}, {0, half}, {0, 1}}};
  for (const auto& [time, speed] : {std::pair{0.5, 0.3}, {1.0, 0.6}, {1.5, 0.3}, {2.0, 0.0}, {2.5, 0.0}})
    EXPECT_NEAR(mean_velocity_after(scene, time * half, 0), speed, 3 * bounce) << time;
  EXPECT_NEAR(mean_velocity_after(sliding({}, rough, {0, -0.8, 0}), half, 1), -0.6, 2 * bounce);  // a belt
}

// The weight compresses the springs by about 1e-6 m; 1e-14 m is round-off.
TEST(Friction, does_not_separate_what_slides) {
  Simulation simulation(sliding({1, 0, 0}, rough));
  int pressed = 0;
  for (int step = 0; step < 1000; ++step) {
    ASSERT_EQ(simulation.step(), StepStatus::ok);
    if (simulation.active() < 9) continue;
    ++pressed;
    for (const double u : simulation.displacement()) ASSERT_NEAR(u, 0, 1e-14);
  }
  EXPECT_GT(pressed, 100);
}

// A body with one contact point, such as a stylus or a bow: the middle of the plate. Its spring is nine times
// as soft as the nine together, so it bounces three times as fast.
TEST(Friction, of_a_solid_with_a_single_patch_brakes_it) {
  Scene scene = sliding({1, 0, 0}, rough);
  scene.bodies[0].kernel = shared(kernels::restricted_to_points(*scene.bodies[0].kernel, {4}));
  EXPECT_NEAR(mean_velocity_after(scene, 0.1, 0), 1 - 0.3 * gravity * 0.1, 3 * bounce);
  Scene rod = rod_at_wall();
  rod.pairs[0].friction = rough;
  EXPECT_NE(complaint_of([&] { Simulation simulation(rod); }).find("rod is a rod"), std::string::npos);
}

// A kernel along the normal alone is enough.
TEST(Friction, of_zero_is_none) {
  Scene scene = falling({}, 1e-4, 1, 9.81);
  scene.pairs[0].friction = Friction{0, 0, 0};
  EXPECT_NO_THROW(Simulation{scene});
  for (const std::optional<Friction>& none : {std::optional(Friction{}), std::optional<Friction>()})
    EXPECT_EQ(mean_velocity_after(sliding({1, 0, 0}, none), 0.1, 0), 1);
}

TEST(TangentialForce, is_that_of_coulomb_on_the_floor) {
  Simulation simulation(sliding({0.6, 0.8, 0}, rough));
  ASSERT_EQ(simulation.tangential_force().size(), 3 * simulation.points().size());
  double impulse = 0;
  for (int step = 0; step < 5000; ++step) {
    ASSERT_EQ(simulation.step(), StepStatus::ok);
    for (std::size_t i = 0; i < simulation.points().size(); ++i) {
      const double drag = 0.3 * simulation.force()[i];
      const auto force = simulation.tangential_force().subspan(3 * i, 3);
      // Vibration across the slip is far below it. 1e-3: the plate tilts as it slows down.
      EXPECT_NEAR(force[0], 0.6 * drag, 1e-3 * weight);
      EXPECT_NEAR(force[1], 0.8 * drag, 1e-3 * weight);
      EXPECT_NEAR(force[2], 0, 1e-12 * weight);
      EXPECT_LE(std::hypot(force[0], force[1]), drag + 1e-9 * weight);
      impulse += force[0] / 44100;
    }
  }
  EXPECT_NEAR(simulation.mean_velocity(0)[0], 0.6 - impulse, 1e-9);
  EXPECT_GT(simulation.energy().friction, 0.1);
  EXPECT_NEAR(simulation.energy().ledger(), 0.5, 1e-9);  // J
}

TEST(TangentialForce, of_blocks_and_saved_states_is_that_of_steps) {
  for (const double contact_rate : {0.0, 4 * 44100.0}) {
    Scene scene = sliding({1, 0.1, 0}, rough);
    scene.contact_rate_hz = contact_rate;
    Simulation whole(scene), single(scene);
    constexpr std::size_t n = 500, m = 9;
    std::vector<double> tangential(n * m * 3), force(n * m);
    const Block out{.force = force.data(), .tangential_force = tangential.data()};
    ASSERT_EQ(whole.step_block(n, out).steps, n);
    for (std::size_t k = 0; k < n * m; ++k)
      ASSERT_LE(std::hypot(tangential[3 * k], tangential[3 * k + 1]), 0.3 * force[k] + 1e-9 * weight) << k;
    const long before = heap_counter::calls;
    int differing = 0;
    for (std::size_t k = 0; k < n; ++k) {
      differing += single.step() != StepStatus::ok;
      for (std::size_t i = 0; i < 3 * m; ++i)
        differing += std::abs(tangential[k * m * 3 + i] - single.tangential_force()[i]) > 1e-9 * weight;
    }
    EXPECT_EQ(heap_counter::calls, before);
    EXPECT_EQ(differing, 0);
    const Simulation::State state = single.save();
    const std::vector<double> then(single.tangential_force().begin(), single.tangential_force().end());
    single.step_block(100);
    ASSERT_TRUE(single.restore(state));
    EXPECT_TRUE(std::ranges::equal(single.tangential_force(), then));
  }
}

TEST(TangentialForce, without_friction_is_zero) {
  Simulation simulation(falling({}, 1e-4, 1, 9.81));
  std::vector<double> tangential(2000 * 3 * 3, 7);
  ASSERT_EQ(simulation.step_block(2000, {.tangential_force = tangential.data()}).steps, 2000);
  EXPECT_EQ(tangential, std::vector<double>(2000 * 3 * 3, 0));
  EXPECT_EQ(simulation.tangential_force().size(), 9);
}

TEST(Simulation, keeps_its_kernels_alive) {
  Scene scene = falling({}, 1e-4, 1, 9.81);
  std::weak_ptr<const kernels::Kernel> kernel = scene.bodies[0].kernel;
  {
    Simulation simulation(scene);
    scene = {};
    EXPECT_FALSE(kernel.expired());
    EXPECT_EQ(simulation.step(), StepStatus::ok);
  }
  EXPECT_TRUE(kernel.expired());
}

TEST(Simulation, refuses_in_one_line_what_it_cannot_run) {
  const auto complaint = [](auto change) {
    Scene scene = falling({}, 1e-4, 1, 9.81);
    change(scene);
    return complaint_of([&] { Simulation simulation(scene); });
  };
  const auto says = [&](auto change, const std::string& part) {
    const std::string text = complaint(change);
    EXPECT_NE(text.find(part), std::string::npos) << part << " in: " << text;
  };
  const double nan = std::nan("");
  says([](Scene& s) { s.bodies[0].kernel = nullptr; }, "bodies.plate: has no kernel");
  says([](Scene& s) { s.bodies.push_back(s.bodies[0]); }, "bodies.plate: the name is taken");
  says([](Scene& s) { s.obstacles[0].name = "plate"; }, "obstacles.plate: the name is taken");
  says([](Scene& s) { s.bodies[0].name = ""; }, "bodies: one has no name");
  says([&](Scene& s) { s.bodies[0].translate[1] = nan; }, "bodies.plate.translate = [0, nan, 0]");
  says([](Scene& s) { s.obstacles[0].normal = {}; }, "obstacles.floor.normal = [0, 0, 0]");
  says([](Scene& s) { s.pairs[0].b = "flour"; }, "\"flour\" is neither a body nor an obstacle");
  says([](Scene& s) { s.pairs[0].gap = -1.0; }, "gap = -1: must not be negative");
  says([](Scene& s) { s.pairs[0].direction = Vector3{}; }, "direction = [0, 0, 0]");
  says([&](Scene& s) { s.gravity[0] = nan; }, "gravity = [nan");
  says([](Scene& s) { s.rate_hz = 0; }, "rate_hz = 0");
  says([](Scene& s) { s.max_pivots = 0; }, "max_pivots = 0: must be at least 1");
  says([](Scene& s) { s.bodies[0].arrival = -1; }, "bodies.plate.arrival = -1: must not be negative");
  const auto forced = [](const Forcing& one) { return [=](Scene& s) { s.forcing = {one}; }; };
  says(forced({.body = "plane", .name = "push"}), "\"plane\" is not a body");
  says(forced({.body = "plate", .name = "push"}), "the kernel of body \"plate\" has no \"push\"");
  says(forced({.body = "plate", .name = "foot", .support = true}), "forcing[0]: 0 times and 0 factors");
  says(forced({.body = "plate", .name = "push", .vector = {nan, 0, 0}}), "forcing[0].vector = [nan");
  says(forced({.body = "plate", .name = "push", .time = {0, 0}, .factor = {0, 1}}),
       "its times do not ascend");
  says([](Scene& s) { s.pickups[0].body = "plane"; }, "pickups[0]: \"plane\" is not a body");
  says([](Scene& s) { s.pickups[0].candidate = 3; },
       "pickups[0]: candidate = 3: the kernel of \"plate\" has 3");
  says([](Scene& s) { s.pickups[0].receiver = "mic"; }, "no receiver \"mic\"");
  says([](Scene& s) { s.pickups[0].direction = {1, 0, 0}; }, "along [0, 0, 1]");
  says([](Scene& s) { s.pickups[0].direction = {}; }, "pickups[0].direction = [0, 0, 0]");
  says(
      [](Scene& s) {
        s.scheme = Scheme::impulse;
        s.restitution = 2;
      },
      "restitution = 2");
  const auto with = [](const Friction& friction) {
    return [=](Scene& s) { s.pairs[0].friction = friction; };
  };
  says(with({-0.1, 0.3, 0}),
       "contact between \"plate\" and \"floor\": friction.static_coefficient = -0.1: must be");
  says(with({0.3, nan, 0}), "friction.dynamic_coefficient = nan: must be from 0 to 10");
  says(with({0.3, 0.2, 0}), "friction.stribeck_velocity = 0: must be above 0");
  says(with({0.3, 0.3, 0}), "the kernel of \"plate\" holds the motion along one direction alone");
  says(
      [](Scene& s) {
        s.pairs[0].friction = {0.3, 0.3, 0};
        s.scheme = Scheme::impulse;
      },
      "friction needs the compliant scheme");
  says([&](Scene& s) { s.obstacles[0].velocity[0] = nan; }, "obstacles.floor.velocity = [nan");
  const auto slides = [](const Slide& slide) { return [=](Scene& s) { s.obstacles[0].slides = {slide}; }; };
  says(slides({{1, 0, 0}, {}, {}}), "obstacles.floor.slides[0]: 0 times and 0 factors");
  says(slides({{1, 0, 0}, {0, 1}, {0}}), "2 times and 1 factors");
  says(slides({{1, 0, 0}, {0, nan}, {0, 1}}), "a time or a factor that is not finite");
  says(slides({{1, 0, 0}, {0, 1}, {0, nan}}), "a time or a factor that is not finite");
  says(slides({{1, 0, 0}, {0, 0}, {0, 1}}), "its times do not ascend");
  says(slides({{nan, 0, 0}, {0, 1}, {0, 1}}), "obstacles.floor.slides[0].vector = [nan");
  says(
      [](Scene& s) {
        kernels::Kernel damaged = *s.bodies[0].kernel;
        damaged.surface.shape.pop_back();
        s.bodies[0].kernel = std::make_shared<const kernels::Kernel>(damaged);
      },
      "bodies.plate.kernel: dataset \"/surface/shape\"");
}

}  // namespace simulation_test
