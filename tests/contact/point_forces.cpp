// SPDX-License-Identifier: BSD-2-Clause
// Forces from outside at points of bodies in a live loop.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/contact/cloud.hpp"
#include "tests/contact/heap_counter.hpp"
#include "tests/contact/plate.hpp"

namespace point_forces_test {

using namespace ricochet;
using contact::test::Cloud;
using contact::test::falling;
using contact::test::shared;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double length = 10;

/// A bar with its foot at x = 0 (tests/contact/bodies.hpp), before a wall.
Scene bar(int modes, double decay, double gap) {
  kernels::Kernel kernel = contact::test::clamped_bar(modes, length);
  kernel.modes.decay_rate.assign(static_cast<std::size_t>(modes), decay);
  Scene scene;
  scene.bodies = {{.name = "bar", .kernel = shared(std::move(kernel))}};
  scene.obstacles = {{.name = "wall", .point = {length + gap, 0, 0}, .normal = {-1, 0, 0}}};
  scene.pairs = {{.a = "bar", .b = "wall"}};
  scene.pickups = {{.body = "bar", .candidate = 1, .direction = {1, 0, 0}}};
  scene.rate_hz = 10;
  return scene;
}

// Each mode is a spring that a force F φ_n acts on from a step on: q = F φ_n/ω² (1 − cos ωt). The point
// itself moves by that and by the flexibility of all other modes, at once. 1e-12: round-off.
TEST(PointForce, moves_modes_as_a_sudden_force_does) {
  constexpr double force = 2, begin = 0.7;
  Simulation simulation(bar(8, 0, 100));
  const kernels::Kernel kernel = contact::test::clamped_bar(8, length);
  simulation.step_block(7);
  ASSERT_TRUE(simulation.push_at(0, {.candidate = 1}, {force, 0, 0}));
  for (int k = 0; k < 100; ++k) {
    ASSERT_EQ(simulation.step(), StepStatus::ok);
    std::vector<double> q(8), v(8);
    simulation.modal_coordinates(0, q.data(), v.data());
    double u = force * kernel.surface.residual_flexibility[3];
    for (std::size_t n = 0; n < 8; ++n) {
      const double omega = kernel.modes.angular_frequency[n], phi = kernel.surface.shape[8 + n],
                   angle = omega * (simulation.time() - begin);
      EXPECT_NEAR(q[n], force * phi / (omega * omega) * (1 - std::cos(angle)), 1e-12 * length) << k;
      EXPECT_NEAR(v[n], force * phi / omega * std::sin(angle), 1e-12 * length) << k;
      u += phi * q[n];
    }
    EXPECT_NEAR(simulation.displacement()[0], u, 1e-12 * length);
    EXPECT_NEAR(simulation.energy().loads, force * simulation.pickup_displacement(0), 1e-12 * length);
  }
}

// At rest, a force F at y displaces the tip by F min(y, L)/(EA), also if half of the modes are above half the
// rate. 1e-9: e^(−0.15 · 200).
TEST(PointForce, stretches_a_bar_as_statics_has_it) {
  for (const double rate : {10.0, 1.2}) {
    Scene scene = bar(20, 0.15, 100);
    scene.rate_hz = rate;
    Simulation simulation(scene);
    EXPECT_EQ(simulation.quasi_static_modes() > 5, rate < 2);
    ASSERT_TRUE(simulation.push_at(0, {.receiver = "mic"}, {0.5, 0, 0}));
    ASSERT_TRUE(simulation.push_at(0, {.candidate = 1}, {2, 0, 0}));
    simulation.step_block(static_cast<std::int64_t>(200 * rate));
    EXPECT_NEAR(simulation.displacement()[0], 0.5 * length / 2 + 2 * length, 1e-9);
    ASSERT_TRUE(simulation.push_at(0, {.candidate = 1}, {}));
    simulation.step_block(static_cast<std::int64_t>(200 * rate));
    EXPECT_NEAR(simulation.displacement()[0], 0.5 * length / 2, 1e-9);
    EXPECT_NEAR(simulation.energy().ledger(), 0, 1e-11);
  }
}

// The bar strikes the wall again and again under the force, which a history lets begin at the same instant,
// and change. 1e-9: round-off, which strikes amplify.
TEST(PointForce, does_what_a_load_of_the_scene_does) {
  Scene scene = bar(20, 0.05, 0.3);
  Simulation pushed(scene);
  constexpr int second = 12;  // before it has reached the wall
  scene.forcing = {{.body = "bar", .name = "tip", .vector = {1, 0, 0}, .time = {0.7}, .factor = {0.1}},
                   {.body = "bar", .name = "tip", .vector = {1, 0, 0}, .time = {1.2}, .factor = {0.3}}};
  Simulation loaded(scene);
  double peak = 0;
  for (int k = 0; k < 600; ++k) {
    if (k == 7) ASSERT_TRUE(pushed.push_at(0, {.candidate = 1}, {0.1, 0, 0}));
    if (k == second) ASSERT_TRUE(pushed.push_at(0, {.candidate = 1}, {0.4, 0, 0}));
    ASSERT_EQ(pushed.step(), StepStatus::ok);
    ASSERT_EQ(loaded.step(), StepStatus::ok);
    if (k == 6 || k + 1 == second) continue;  // the history has begun at the end of this step
    ASSERT_NEAR(pushed.force()[0], loaded.force()[0], 1e-9) << k;
    ASSERT_NEAR(pushed.displacement()[0], loaded.displacement()[0], 1e-9) << k;
    ASSERT_NEAR(pushed.pickup_velocity(0), loaded.pickup_velocity(0), 1e-9) << k;
    ASSERT_NEAR(pushed.energy().loads, loaded.energy().loads, 1e-9) << k;
    peak = std::max(peak, pushed.force()[0]);
  }
  EXPECT_GT(peak, 0.1);
}

/// The schemes of bodies that do not turn.
std::vector<Scene> schemes(const Scene& compliant) {
  Scene jump = compliant, exact = compliant, fine = compliant, single = compliant;
  jump.scheme = exact.scheme = Scheme::impulse;
  exact.instant = Instant::exact;
  fine.contact_rate_hz = 4 * compliant.rate_hz;
  single.precision = Precision::float32;
  return {compliant, fine, single, jump, exact};
}

/// Changes forces at contact points and at others before step k.
void play(Simulation& simulation, int k, const Vector3& along) {
  if (k % 53 != 0) return;
  const double force = 30.0 * (k % 4);
  for (const std::size_t candidate : {0, 2})
    ASSERT_TRUE(simulation.push_at(0, {.candidate = candidate},
                                   {force * along[0], force * along[1], force * along[2]}));
}

/// A box over a floor with friction.
Scene box(Rotation rotation, const Vector3& spin = {0, 0, 0}) {
  Scene scene;
  scene.rotation = rotation;
  scene.rate_hz = 20e3;
  scene.gravity = {0, 0, -9.81};
  scene.obstacles = {{.name = "floor", .normal = {0, 0, 1}}};
  scene.bodies = {{.name = "box",
                   .kernel = shared(Cloud({0.1, 0.08, 0.06}, 2000, 1e-8, 3, true, 0.1).kernel),
                   .translate = {0, 0, 0.04},
                   .angular_velocity = spin}};
  scene.pairs = {{.a = "box", .b = "floor", .friction = Friction{0.3, 0.3, 0}}};
  scene.pickups = {{.body = "box", .candidate = 1, .direction = {0, 0, 1}}};
  return scene;
}

// Blocks of steps under forces that change between them, in contact and in flight. Energies are those of the
// start with the work of the forces, to round-off of all that has been exchanged.
TEST(PointForce, acts_in_blocks_as_in_steps_and_keeps_the_ledger) {
  std::vector<std::pair<Scene, Vector3>> cases;
  for (const Scene& scene : schemes(falling({.ratio = 0.01}, 1e-4, 0.3, 9.81)))
    cases.push_back({scene, {0, 0, -1}});
  for (const Rotation rotation : {Rotation::linear, Rotation::finite})
    cases.push_back({box(rotation), {0.02, 0.01, -0.05}});
  for (std::size_t c = 0; c < cases.size(); ++c) {
    SCOPED_TRACE(c);
    const auto& [scene, along] = cases[c];
    Simulation whole(scene), single(scene);
    const double start = single.energy().ledger();
    double exchanged = start, work = 0;
    int touching = 0;
    for (int k = 0; k < 1060; k += 53) {
      play(whole, k, along);
      std::vector<double> velocity(53), force(53);
      ASSERT_EQ(whole.step_block(53, {.velocity = velocity.data(), .total_force = force.data()}).steps, 53);
      for (int l = 0; l < 53; ++l) {
        play(single, k + l, along);
        ASSERT_EQ(single.step(), StepStatus::ok);
        ASSERT_EQ(single.pickup_velocity(0), velocity[static_cast<std::size_t>(l)]) << k + l;
        double sum = 0;
        for (const double one : single.force()) sum += one;
        ASSERT_NEAR(sum, force[static_cast<std::size_t>(l)], 1e-13 * sum);
        touching += single.active() > 0;
      }
      const Energy e = single.energy();
      exchanged = std::max(exchanged, e.kinetic + e.strain + std::abs(e.loads) + e.contact);
      work = std::max(work, std::abs(e.loads));
      // Single precision rounds the forces of contact.
      ASSERT_NEAR(e.ledger(), start, (scene.precision == Precision::float32 ? 1e-5 : 1e-12) * exchanged) << k;
      ASSERT_NEAR(whole.energy().loads, e.loads, 1e-12 * exchanged);
    }
    EXPECT_GT(touching, 20);
    EXPECT_GT(work, 1e-4);
  }
}

// Forces press the plate on the floor, which bears them and the weight. 1e-6: what is left of the vibration
// after 2 s, e^(−0.05 · 300 · 2), and the tilt of single points.
TEST(PointForce, presses_a_plate_on_the_floor) {
  Simulation simulation(falling({.modes = 4, .ratio = 0.05, .rigid_decay = 5}, 1e-5, 0, 9.81));
  for (const std::size_t candidate : {0, 1, 2})
    ASSERT_TRUE(simulation.push_at(0, {.candidate = candidate}, {0, 0, -5}));
  simulation.step_block(3 * 44100);
  double sum = 0;
  for (const double force : simulation.force()) sum += force;
  EXPECT_NEAR(sum, 2 * 9.81 + 15, 1e-6 * sum);
}

/// A free box in space.
Scene free_box(const Cloud& cloud, const Vector3& spin) {
  Scene scene;
  scene.rotation = Rotation::finite;
  scene.rate_hz = 1e5;
  scene.obstacles = {{.name = "floor", .point = {0, 0, -100}, .normal = {0, 0, 1}}};
  scene.pairs = {{.a = "box", .b = "floor"}};
  scene.bodies = {
      {.name = "box", .kernel = shared(cloud.kernel), .rotate_deg = {20, 30, 40}, .angular_velocity = spin}};
  scene.pickups = {{.body = "box", .candidate = 5, .direction = {1, 0, 0}},
                   {.body = "box", .candidate = 5, .direction = {0, 1, 0}},
                   {.body = "box", .candidate = 5, .direction = {0, 0, 1}}};
  return scene;
}

// As a whole, the box speeds up by F/m and by J⁻¹ (r × F). Its modes follow F φ/ω² (1 − cos ωt). 1e-7: it
// turns by less than that, under which the arm and the axes of modes change.
TEST(PointForce, moves_and_turns_a_free_body_and_deforms_it) {
  const Cloud cloud({0.1, 0.08, 0.06}, 500, 0, 3);
  Simulation simulation(free_box(cloud, {}));
  const Vector3d force(2e-3, -1e-3, 3e-3);
  ASSERT_TRUE(simulation.push_at(0, {.candidate = 5}, {force.x(), force.y(), force.z()}));
  const int steps = 40;
  simulation.step_block(steps);
  const double t = steps / 1e5;
  const BodyMotion motion = simulation.body_motion(0);
  const auto [w, x, y, z] = motion.attitude;
  const Matrix3d Q = Eigen::Quaterniond(w, x, y, z).toRotationMatrix();
  const Vector3d own = Q.transpose() * force, arm = Vector3d(&cloud.kernel.surface.node[15]) - cloud.centre,
                 spin = Q * cloud.inertia.inverse() * arm.cross(own) * t, velocity = force / cloud.mass * t;
  EXPECT_LT((Vector3d(motion.velocity.data()) - velocity).norm(), 1e-12 * velocity.norm());
  EXPECT_LT((Vector3d(motion.spin.data()) - spin).norm(), 1e-7 * spin.norm());
  const std::size_t modes = cloud.kernel.modes.size();
  std::vector<double> q(modes);
  simulation.modal_coordinates(0, q.data(), nullptr);
  const Eigen::Map<const contact::Matrix> shape(&cloud.kernel.surface.shape[15 * modes], 3,
                                                static_cast<Eigen::Index>(modes));
  double largest = 0, apart = 0;
  for (Eigen::Index n = 6; n < shape.cols(); ++n) {
    const double omega = cloud.kernel.modes.angular_frequency[static_cast<std::size_t>(n)],
                 expected = own.dot(shape.col(n)) / (omega * omega) * (1 - std::cos(omega * t));
    largest = std::max(largest, std::abs(expected));
    apart = std::max(apart, std::abs(q[static_cast<std::size_t>(n)] - expected));
  }
  EXPECT_GT(largest, 0);
  EXPECT_LT(apart, 1e-6 * largest);
}

// The work is that of the force over the way of the point, F·(x − x₀). 1e-4: the arm is that of the
// undeformed body, and elastic displacements are below 1e-5 of it; the turn of a step is that of its middle,
// (ΩΔ)² = 1e-5. The ledger closes to round-off.
TEST(PointForce, is_constant_in_the_world_while_a_body_spins) {
  const Cloud cloud({0.1, 0.08, 0.06}, 500, 0, 3);
  const Vector3d force(3, -2, 5);
  Simulation simulation(free_box(cloud, {200, -300, 100}));
  const double start = simulation.energy().ledger();
  ASSERT_TRUE(simulation.push_at(0, {.candidate = 5}, {force.x(), force.y(), force.z()}));
  double turned = 0, largest = 0;
  for (int k = 0; k < 1000; ++k) {
    ASSERT_EQ(simulation.step(), StepStatus::ok);
    turned += Vector3d(simulation.body_motion(0).spin.data()).norm() / 1e5;
    largest = std::max(largest, std::abs(simulation.energy().loads));
  }
  EXPECT_GT(turned, 3);
  EXPECT_NEAR(simulation.energy().ledger(), start, 1e-12 * (start + largest));
  double way = 0;
  for (const std::size_t axis : {0, 1, 2})
    way += force(static_cast<Eigen::Index>(axis)) * simulation.pickup_displacement(axis);
  EXPECT_NEAR(simulation.energy().loads, way, 1e-4 * largest);
  const Vector3d speed = force / cloud.mass * simulation.time();  // of the centre
  EXPECT_LT((Vector3d(simulation.body_motion(0).velocity.data()) - speed).norm(), 1e-11 * speed.norm());
}

TEST(PointForce, wakes_a_body_and_ends_with_it) {
  Scene scene = box(Rotation::finite);
  kernels::Kernel damped = Cloud({0.1, 0.08, 0.06}, 2000, 1e-8, 3, true, 0).kernel;
  for (std::size_t n = 6; n < damped.modes.size(); ++n)
    damped.modes.decay_rate[n] = 0.2 * damped.modes.angular_frequency[n];
  const SharedKernel kernel = scene.bodies[0].kernel = shared(damped);
  Simulation simulation(scene);
  simulation.step_block(20'000);
  const double weight = 9.81 * kernel->mass, rest = simulation.body_motion(0).velocity[0];
  EXPECT_NEAR(rest, 0, 1e-9);
  ASSERT_TRUE(simulation.push_at(0, {.candidate = 13}, {2 * weight, 0, 0}));
  simulation.step_block(200);
  EXPECT_GT(simulation.body_motion(0).velocity[0], 1e-2);
  simulation.remove(0);
  EXPECT_FALSE(simulation.push_at(0, {.candidate = 13}, {1, 0, 0}));
  // It takes the place of the other one, but not its force.
  const std::size_t next = simulation.add("next", kernel, {.position = {0, 0, 1}}, Friction{0.3, 0.3, 0});
  simulation.step_block(200);
  EXPECT_EQ(simulation.body_motion(next).velocity[0], 0);
  EXPECT_NEAR(simulation.body_motion(next).velocity[2], -9.81 * 0.01, 1e-12);
  // A body that moves to another model keeps its force.
  ASSERT_TRUE(simulation.push_at(next, {.candidate = 13}, {0, 0, weight}));
  simulation.add("other", kernel, {.position = {1, 0, 1}});
  simulation.step_block(200);
  EXPECT_NEAR(simulation.body_motion(next).velocity[2], -9.81 * 0.01, 1e-9);
}

/// Gives a kernel more elastic modes, so that its shapes no longer fit the nearest cache.
kernels::Kernel widened(kernels::Kernel kernel, std::size_t modes) {
  const std::size_t before = kernel.modes.size();
  for (std::size_t n = before; n < modes; ++n) {
    kernel.modes.angular_frequency.push_back(1.01 * kernel.modes.angular_frequency.back());
    kernel.modes.decay_rate.push_back(0);
  }
  for (std::vector<double>* rows :
       {&kernel.surface.shape, &kernel.loads.body_force, &kernel.loads.rotation}) {
    std::vector<double> wide;
    for (std::size_t i = 0; i < rows->size(); i += before)
      for (std::size_t n = 0; n < modes; ++n)
        // Elastic modes carry no momentum; their shapes are like those of the others.
        wide.push_back(n < before                      ? (*rows)[i + n]
                       : rows == &kernel.surface.shape ? (*rows)[i + 6 + (n + i / before) % (before - 6)]
                                                       : 0);
    *rows = std::move(wide);
  }
  return kernel;
}

// Where shapes exceed the nearest cache, a step computes the free motion of the next one beforehand, and a
// push changes that motion. A state that is restored expects nothing. Without the push, forces are others.
TEST(PointForce, changes_a_motion_that_was_computed_beforehand) {
  Scene scene = box(Rotation::finite);
  scene.bodies[0].kernel = shared(widened(Cloud({0.1, 0.08, 0.06}, 2000, 1e-8, 3, true, 0).kernel, 300));
  Simulation simulation(scene);
  while (simulation.active() == 0) ASSERT_EQ(simulation.step(), StepStatus::ok);
  const std::vector<std::byte> state = simulation.save().bytes();
  const auto pushed = [&](Simulation& one, double force) {
    EXPECT_TRUE(one.push_at(0, {.candidate = 25}, {0, 0, force}));
    EXPECT_EQ(one.step(), StepStatus::ok);
    return std::vector<double>(one.force().begin(), one.force().end());
  };
  Simulation restored(scene), free(scene);
  for (Simulation* other : {&restored, &free}) ASSERT_TRUE(other->restore(other->state(state)));
  const std::vector<double> force = pushed(restored, -50);
  EXPECT_EQ(pushed(simulation, -50), force);
  EXPECT_NE(pushed(free, 0), force);
}

TEST(PointForce, takes_no_memory) {
  for (const Scene& scene :
       {falling({}, 1e-4, 1, 9.81), box(Rotation::linear), box(Rotation::finite, {1, 2, 3})}) {
    Simulation simulation(scene);
    simulation.step_block(100);
    const Simulation::State state = simulation.save();
    const long before = heap_counter::calls;
    bool done = true;
    for (int k = 0; k < 200; ++k) {
      done = done && simulation.push_at(0, {.candidate = static_cast<std::size_t>(k % 3)}, {0, 0, -0.01 * k});
      done = done && simulation.step() == StepStatus::ok;
    }
    done = done && simulation.restore(state);
    EXPECT_EQ(heap_counter::calls, before);
    EXPECT_TRUE(done);
  }
}

TEST(PointForce, is_refused_where_there_is_no_point) {
  Scene scene = falling({}, 1e-4, 0, 9.81);
  kernels::Kernel kernel = *scene.bodies[0].kernel;
  kernel.receivers.resize(1025);
  for (std::size_t k = 0; k < kernel.receivers.size(); ++k) {
    kernel.receivers[k].name = "r" + std::to_string(k);
    kernel.receivers[k].shape.assign(3 * kernel.modes.size(), 0);
  }
  scene.bodies[0].kernel = shared(std::move(kernel));
  Simulation simulation(scene);
  const Vector3 down{0, 0, -1};
  EXPECT_TRUE(simulation.push_at(0, {.candidate = 2}, down));
  EXPECT_FALSE(simulation.push_at(1, {.candidate = 2}, down));
  EXPECT_FALSE(simulation.push_at(0, {.candidate = 3}, down));
  EXPECT_FALSE(simulation.push_at(0, {.candidate = static_cast<std::size_t>(-1)}, down));
  EXPECT_FALSE(simulation.push_at(0, {.receiver = "mic"}, down));
  EXPECT_FALSE(simulation.push_at(0, {.candidate = 2}, {0, 0, std::nan("")}));
  EXPECT_FALSE(simulation.push_at(0, {.candidate = 2}, {0.1, 0, -1}));  // the kernel holds z alone
  EXPECT_TRUE(simulation.push_at(0, {.candidate = 2}, {}));
  for (int k = 0; k < 1024; ++k)
    ASSERT_TRUE(simulation.push_at(0, {.receiver = "r" + std::to_string(k)}, down));
  EXPECT_FALSE(simulation.push_at(0, {.receiver = "r1024"}, down));
  EXPECT_TRUE(simulation.push_at(0, {.receiver = "r7"}, {}));
  EXPECT_TRUE(simulation.push_at(0, {.receiver = "r1024"}, down));
}

}  // namespace point_forces_test
