// SPDX-License-Identifier: BSD-2-Clause
// Loads with histories, moving supports and receivers of bodies that turn by any angle.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "contact/figures/receivers.hpp"
#include "contact/stepping/stepper.hpp"
#include "tests/contact/cloud.hpp"
#include "tests/contact/heap_counter.hpp"
#include "tests/drawn.hpp"

namespace ricochet::contact::test {
namespace {

std::vector<double> values(const Matrix& x) { return {x.data(), x.data() + x.size()}; }

/// Adds the point force "push" at a candidate, its receiver "mic", and the motion "base" of all supports
/// together, to which the whole body follows statically.
void add_sources(Cloud& cloud, int candidate) {
  kernels::Kernel& kernel = cloud.kernel;
  const auto modes = static_cast<Eigen::Index>(kernel.modes.size()),
             rows = static_cast<Eigen::Index>(3 * kernel.surface.size());
  const Eigen::Map<const Matrix> shape(kernel.surface.shape.data(), rows, modes);
  Matrix R = Matrix::Zero(rows, rows);
  if (!kernel.surface.residual_flexibility.empty())
    R = Eigen::Map<const Matrix>(kernel.surface.residual_flexibility.data(), rows, rows);
  const Vector3d at =
      Eigen::Map<const Vector3d>(&kernel.surface.node[static_cast<std::size_t>(3 * candidate)]);
  const Matrix own = shape.middleRows(3 * candidate, 3), of_push = R.middleCols(3 * candidate, 3);
  kernel.applied = {{.name = "push",
                     .unit = "N",
                     .participation = values(own),
                     .total = values(Matrix3d::Identity()),
                     .moment = values(cross_matrix(at)),
                     .residual = values(of_push)}};
  kernel.receivers = {{.name = "mic",
                       .point = {at.x(), at.y(), at.z()},
                       .shape = values(own),
                       .residual_flexibility = values(R.middleRows(3 * candidate, 3)),
                       .body_force_residual = std::vector<double>(9, 0),
                       .load_residual = values(of_push.middleRows(3 * candidate, 3)),
                       .motion_residual = {}}};
  if (!kernel.supported) return;
  kernel.motions = {{.name = "base",
                     .participation = kernel.loads.body_force,
                     .residual = std::vector<double>(static_cast<std::size_t>(3 * rows), 0),
                     .momentum = std::vector<double>(9, 0)}};
  kernel.receivers[0].motion_residual.assign(9, 0);
}

ForcingRequest push(const Vector3d& force, History history = {}, std::optional<Axes> axes = {}) {
  return {.body = "cloud", .name = "push", .vector = force, .history = std::move(history), .axes = axes};
}

/// Steps both schemes side by side and compares forces, receivers and energies.
void expect_equal(const Cloud& cloud, Drop drop, const std::vector<ForcingRequest>& forcing, double rate,
                  int steps) {
  const StepOptions of_finite = stepping(rate), of_linear = stepping(rate, Rotation::linear);
  const auto turning = fold(over_floor(cloud, drop, forcing), of_finite);
  drop.turns = false;
  const auto fixed = fold(over_floor(cloud, drop, forcing), of_linear);
  auto finite = make_stepper(turning, of_finite), linear = make_stepper(fixed, of_linear);
  Receivers heard(*turning, of_finite), expected(*fixed, of_linear);
  double peak = 0, most = 0, work = 0;
  Eigen::Array3d apart = Eigen::Array3d::Zero(), scale = apart;
  for (int k = 0; k < steps; ++k) {
    ASSERT_EQ(finite->step(), StepStatus::ok);
    ASSERT_EQ(linear->step(), StepStatus::ok);
    heard.observe(*finite);
    expected.observe(*linear);
    peak = std::max(peak, linear->force().cwiseAbs().maxCoeff());
    most = std::max(most, std::abs(finite->force().sum() - linear->force().sum()));
    const Energy one = finite->modal()->energy(), other = linear->modal()->energy();
    work = std::max(work, std::abs(other.loads) + other.kinetic + other.strain);
    EXPECT_NEAR(one.loads, other.loads, 1e-10 * work) << k;
    EXPECT_NEAR(one.total(), other.total(), 1e-10 * work) << k;
    EXPECT_NEAR(one.ledger(), initial_energy(*turning).ledger(), 1e-10 * work) << k;
    const ReceiverMotion &at = heard[0], &there = expected[0];
    scale = scale.cwiseMax(
        Eigen::Array3d(there.displacement.norm(), there.velocity.norm(), there.acceleration.norm()));
    apart = apart.cwiseMax(Eigen::Array3d((at.displacement - there.displacement).norm(),
                                          (at.velocity - there.velocity).norm(),
                                          (at.acceleration - there.acceleration).norm()));
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_GT(peak, 1);
  EXPECT_GT(work, 0);
  // Round-off, which touches amplify
  EXPECT_LT(most, 1e-8 * peak);
  EXPECT_LT((apart / scale).maxCoeff(), 1e-8);
}

/// With an inertia that is too large to turn it. Histories change within steps; some modes are folded.
TEST(TurningLoads, without_a_turn_are_those_of_the_linear_scheme) {
  for (const double rate : {1e5, 1e4})
    for (const Axes axes : {Axes::world, Axes::body}) {
      Cloud cloud({0.1, 0.08, 0.06}, 2000, 1e-8, 3);
      cloud.hold_attitude();
      add_sources(cloud, 4);
      const double t = 1 / rate;
      expect_equal(cloud, {.rotation = turn(0.3, {1, 2, 0}), .velocity = {0.3, 0, -1}, .height = 1e-5},
                   {push({40, 10, -300}, {{2.3 * t, 17.8 * t, 60.4 * t}, {0.2, 1, 0}}, axes),
                    push({5, 0, -20}, {{30.5 * t, 31.2 * t}, {0, 1}}, axes)},
                   rate, 150);
    }
}

TEST(TurningLoads, and_moving_supports_of_a_supported_body_are_those_of_the_linear_scheme) {
  for (const double rate : {1e5, 1e4}) {
    Cloud cloud({0.1, 0.08, 0.06}, 2000, 1e-8, 3);
    cloud.support();
    add_sources(cloud, 4);
    for (double& x : cloud.kernel.modes.decay_rate) x = 30;
    const double t = 1 / rate;
    const ForcingRequest shake{.body = "cloud",
                               .name = "base",
                               .support = true,
                               .vector = {1e-5, 0, -1e-4},
                               .history = {{3.4 * t, 50.7 * t, 90 * t}, {0, 1, 0.5}}};
    expect_equal(cloud, {.rotation = turn(0.3, {1, 2, 0}), .height = 5e-5, .gravity = {0, 0, 0}},
                 {shake, push({4, 1, -30}, {{2.3 * t, 17.8 * t}, {0.2, 1}})}, rate, 150);
  }
}

/// Under gravity and a dead load, with all modes and with folded ones. Its place is that of the linear
/// scheme.
TEST(TurningLoads, that_have_always_acted_let_supported_bodies_start_at_rest) {
  for (const double rate : {1e5, 1e4}) {
    Cloud cloud({0.1, 0.08, 0.06}, 2000, 1e-8, 3);
    cloud.support();
    add_sources(cloud, 4);
    Drop drop{.rotation = turn(0.3, {1, 2, 0}), .height = 0.1};
    const std::vector<ForcingRequest> forcing{push({4, 1, -30}, dead_load)};
    const StepOptions options = stepping(rate), of_linear = stepping(rate, Rotation::linear);
    const auto model = fold(over_floor(cloud, drop, forcing), options);
    drop.turns = false;
    const auto fixed = fold(over_floor(cloud, drop, forcing), of_linear);
    auto stepper = make_stepper(model, options);
    EXPECT_EQ(stepper->modal()->modes_in_residual() > 0, rate < 1e5);
    const auto linear = make_stepper(fixed, of_linear);
    for (Eigen::Index i = 0; i < fixed->points(); ++i)  // the points that face the floor
      for (Eigen::Index j = 0; j < model->points(); ++j)
        if (model->point_a.row(j) == fixed->point_a.row(i)) {
          EXPECT_NEAR(stepper->displacement()(j), linear->displacement()(i), 1e-15);
        }
    Receivers heard(*model, options);
    const Receivers expected(*fixed, of_linear);
    const double sag = expected[0].displacement.norm();
    EXPECT_GT(sag, 1e-5);
    for (int k = 0; k < 300; ++k) {
      EXPECT_LT((heard[0].displacement - expected[0].displacement).norm(), 1e-12 * sag) << k;
      EXPECT_LT(heard[0].velocity.norm() / rate, 1e-12 * sag) << k;
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      heard.observe(*stepper);
    }
  }
}

/// Under a force that is constant in the world at a point of a rigid body, the centre obeys Galilei, and the
/// energy of the body is the work on the way of the point.
TEST(TurningLoads, of_the_world_accelerate_the_centre_and_work_on_the_way_of_their_point) {
  std::vector<double> errors;
  for (const double rate : {2e3, 4e3}) {
    Cloud cloud({0.1, 0.08, 0.06}, 500, 0, 3, false);
    add_sources(cloud, 4);
    const Vector3d force(0.3, -0.2, 0.5);
    const auto model =
        over_floor(cloud, {.spin = {3, 20, 5}, .height = 5, .gravity = {0, 0, 0}}, {push(force)});
    auto stepper = make_stepper(model, stepping(rate));
    const Energy before = stepper->modal()->energy();
    const Pose start = stepper->poses()[0];
    const Vector3d arm = Eigen::Map<const Vector3d>(&cloud.kernel.surface.node[12]) - cloud.centre;
    const double t = 0.5;
    for (int k = 0; k < std::lround(t * rate); ++k) ASSERT_EQ(stepper->step(), StepStatus::ok);
    const Pose end = stepper->poses()[0];
    EXPECT_LT((end.velocity - t * force / cloud.mass).norm(), 1e-12);
    EXPECT_LT((end.position - start.position - 0.5 * t * t * force / cloud.mass).norm(), 1e-12);
    EXPECT_GT(end.attitude.angularDistance(start.attitude), 0.1);
    const Energy after = stepper->modal()->energy();
    EXPECT_NEAR(after.kinetic - before.kinetic, after.loads, 1e-12 * after.kinetic);
    const double work = force.dot(end.at(arm) - start.at(arm));
    EXPECT_GT(std::abs(work - force.dot(end.position - start.position)), 0.01 * std::abs(work));
    errors.push_back(after.loads - work);
  }
  EXPECT_LT(std::abs(errors[0]), 1e-4);
  EXPECT_NEAR(errors[0] / errors[1], 4, 0.5);  // second order
}

/// A ball that spins about z, pushed through its centre along its own x: v = F/(mΩ) (sin Ωt, 1 − cos Ωt). So
/// does a traction, unless the scene says otherwise.
TEST(TurningLoads, of_the_body_turn_with_it) {
  Cloud cloud({0.1, 0.1, 0.1}, 500, 0, 3, false, 0);
  add_sources(cloud, 4);
  kernels::Load& load = cloud.kernel.applied[0];
  load.moment = values(cross_matrix(cloud.centre));
  const double spin = 50, rate = 1e4, t = 0.1, force = 2;
  for (const auto& [unit, axes, follows] :
       {std::tuple("N", std::optional(Axes::body), true), std::tuple("Pa", std::optional<Axes>(), true),
        std::tuple("Pa", std::optional(Axes::world), false)}) {
    load.unit = unit;
    const Matrix3d placed = turn(0.7, {0, 0, 1});  // the vector of the load is given in the world
    auto stepper = make_stepper(
        over_floor(cloud, {.rotation = placed, .spin = {0, 0, spin}, .height = 5, .gravity = {0, 0, 0}},
                   {push({force, 0, 0}, {}, axes)}),
        stepping(rate));
    for (int k = 0; k < std::lround(t * rate); ++k) ASSERT_EQ(stepper->step(), StepStatus::ok);
    const Vector3d turned =
                       force / (cloud.mass * spin) * Vector3d(std::sin(spin * t), 1 - std::cos(spin * t), 0),
                   straight(force * t / cloud.mass, 0, 0);
    // The force of a step is that of its middle: relative error (ΩΔ)²/24, and as much by the free rotation.
    EXPECT_LT((stepper->poses()[0].velocity - (follows ? turned : straight)).norm(), 1e-5 * turned.norm())
        << unit;
  }
}

/// The components of a pressure are those of the body, however it is placed.
TEST(TurningLoads, of_a_pressure_do_not_depend_on_the_placement) {
  Cloud cloud({0.1, 0.1, 0.1}, 500, 0, 3, false, 0);
  add_sources(cloud, 4);
  kernels::Load& load = cloud.kernel.applied[0];
  load.unit = "Pa";
  load.inward = true;
  load.total = {3, 0, 0, 0, 4, 0, 0, 0, 5};
  const Matrix3d placed = turn(0.7, {0, 0, 1});
  ForcingRequest request = push({1, 0, 0}, {});
  EXPECT_THROW(over_floor(cloud, {.rotation = placed, .height = 5}, {request}), InputError);
  request.pressure = 2;
  const auto model = over_floor(cloud, {.rotation = placed, .height = 5}, {request});
  EXPECT_LT((model->forcing[0].total - placed * Vector3d(6, 8, 10)).norm(), 1e-14);
  EXPECT_TRUE(model->forcing[0].follows);
  load.inward = false;
  EXPECT_THROW(over_floor(cloud, {.rotation = placed, .height = 5}, {request}), InputError);
}

TEST(Receivers, of_a_rigid_body_that_spins_move_on_a_circle) {
  Cloud cloud({0.1, 0.08, 0.06}, 500, 0, 3, false, 0);
  add_sources(cloud, 0);
  const double spin = 30, rate = 1e4, step = 2 * M_PI / 5;
  const StepOptions options = stepping(rate);
  const Matrix3d placed = turn(0.4, {1, 2, 3});
  const Vector3d axis = placed * Vector3d::UnitZ();
  const auto model = over_floor(
      cloud,
      {.rotation = placed, .velocity = {1, 2, 0}, .spin = spin * axis, .height = 5, .gravity = {0, 0, 0}},
      {});
  for (const Axes axes : {Axes::world, Axes::body}) {
    model->receivers[0].axes = axes;
    auto stepper = make_stepper(model, options);
    Receivers receivers(*model, options);
    const Vector3d arm = placed * Eigen::Map<const Vector3d>(&cloud.kernel.surface.node[0]);
    while (stepper->time() * spin < step) ASSERT_EQ(stepper->step(), StepStatus::ok);
    receivers.observe(*stepper);
    const double t = stepper->time();
    const Matrix3d turned = turn(spin * t, axis), seen = axes == Axes::world
                                                             ? Matrix3d::Identity()
                                                             : Matrix3d((turned * placed).transpose());
    const Vector3d now = turned * arm, drift = t * Vector3d(1, 2, 0);
    const double lost = 1e-6;  // of the angle: (ΩΔ)²/12
    EXPECT_LT((receivers[0].displacement - seen * (drift + now - arm)).norm(), 10 * lost * arm.norm());
    EXPECT_LT((receivers[0].velocity - seen * (Vector3d(1, 2, 0) + spin * axis.cross(now))).norm(),
              10 * lost * 3);
    EXPECT_LT((receivers[0].acceleration - seen * (spin * spin * axis.cross(axis.cross(now)))).norm(),
              10 * lost * spin * spin * arm.norm());
    EXPECT_GT((receivers[0].velocity - seen * Vector3d(1, 2, 0)).norm(), 0.5);
  }
}

/// The rates are those of the displacement, under a load of the world at another angle in each step.
TEST(Receivers, of_a_loaded_body_that_turns_have_the_rates_of_their_displacement) {
  Cloud cloud({0.1, 0.08, 0.06}, 200, 1e-7, 3);
  add_sources(cloud, 4);
  const StepOptions options = stepping(1e5);
  const auto model = fold(
      over_floor(cloud, {.spin = {20, 0, 10}, .height = 5}, {push({3, 5, 4}, {{0, 1}, {0, 1}})}), options);
  auto stepper = make_stepper(model, options);
  Receivers receivers(*model, options);
  std::vector<ReceiverMotion> seen;
  for (int k = 0; k < 1000; ++k) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    receivers.observe(*stepper);
    seen.push_back(receivers[0]);
  }
  double fast = 0, pulled = 0, rate = 0, second = 0;
  for (std::size_t k = 1; k + 1 < seen.size(); ++k) {
    fast = std::max(fast, seen[k].velocity.norm());
    pulled = std::max(pulled, seen[k].acceleration.norm());
    rate = std::max(rate,
                    ((seen[k + 1].displacement - seen[k - 1].displacement) * 5e4 - seen[k].velocity).norm());
    second =
        std::max(second, ((seen[k + 1].velocity - seen[k - 1].velocity) * 5e4 - seen[k].acceleration).norm());
  }
  EXPECT_LT(rate, 1e-4 * fast);      // (ωΔ)²/6 of vibrations, whose share is small
  EXPECT_LT(second, 1e-2 * pulled);  // (ωΔ)²/6 = 2e-3 of the highest modes, and the load's static response
}

/// A box is pushed into its neighbour by a load that begins between two searches, or in a flight.
TEST(TurningLoads, that_begin_between_two_searches_press_bodies_together) {
  Cloud box({0.1, 0.08, 0.06}, 2000, 1e-8, 1, true, 0);
  add_sources(box, 12);
  box.kernel.receivers.clear();
  for (const int per_sample : {1, 16})
    for (const double gap : {1e-5, 3e-5}) {
      std::vector<PlacedBody> bodies{
          {.name = "cloud", .kernel = &box.kernel},
          {.name = "next", .kernel = &box.kernel, .translation = {0.1 + gap, -0.004, 0.005}}};
      PairRequest pair{"cloud", "next", {}, {}, {}};
      pair.everywhere = true;
      const double rate = 44100, step = 1 / rate, force = 540;
      const auto model = std::make_shared<Model>(build_model(
          bodies, {}, {pair}, Vector3d::Zero(),
          {push({force, 0, 0}, {{20.3 * step, 20.4 * step, 40 * step, 40.1 * step}, {0, 1, 1, 0}})}));
      auto stepper = make_stepper(model, stepping(rate, Rotation::finite, per_sample));
      const double impulse = 19.7 * step * force;
      const Pose &first = stepper->poses()[0], &second = stepper->poses()[1];
      double closest = 1;
      while (stepper->steps() < 800) {
        ASSERT_EQ(stepper->step(), StepStatus::ok);
        closest = std::min(closest, second.position.x() - first.position.x() - 0.1);
      }
      EXPECT_NEAR(box.mass * (first.velocity.x() + second.velocity.x()), impulse, 1e-9 * impulse);
      EXPECT_GT(second.velocity.x(), 0.4 * impulse / box.mass) << gap;
      EXPECT_LT(first.velocity.x(), second.velocity.x());
      // Their modes give way by 3e-5. If the touch were found in the next search, it would be 1e-4
      // deep.
      EXPECT_GT(closest, -7e-5);
    }
}

/// A support sinks so slowly that nothing but its motion brings the body down to the floor.
TEST(TurningLoads, lower_a_supported_body_to_the_floor) {
  Cloud cloud({0.1, 0.08, 0.06}, 2000, 1e-8, 3);
  cloud.support();
  add_sources(cloud, 4);
  const ForcingRequest sinks{.body = "cloud",
                             .name = "base",
                             .support = true,
                             .vector = {0, 0, -1e-4},
                             .history = {{0.01005, 0.21005}, {0, 1}}};
  Drop drop{.rotation = turn(0.3, {1, 2, 0}), .height = 5e-5, .gravity = {0, 0, 0}};
  auto finite = make_stepper(over_floor(cloud, drop, {sinks}), stepping(1e4, Rotation::finite, 16));
  drop.turns = false;
  auto linear = make_stepper(over_floor(cloud, drop, {sinks}), stepping(1e4, Rotation::linear, 16));
  double peak = 0, most = 0;
  int calls = 0;
  for (int sample = 1; sample <= 150; ++sample) {
    for (; finite->steps() < 16 * sample; ++calls) ASSERT_EQ(finite->step(), StepStatus::ok);
    while (linear->steps() < 16 * sample) ASSERT_EQ(linear->step(), StepStatus::ok);
    peak = std::max(peak, linear->force().sum());
    most = std::max(most, std::abs(finite->force().sum() - linear->force().sum()));
  }
  EXPECT_LE(calls, 6 + 16 * 144);
  EXPECT_GT(peak, 1);
  EXPECT_LT(most, 1e-7 * peak);
}

/// Flights end before a load begins, and go on after it has ended.
TEST(TurningLoads, are_stepped_through_and_the_rest_is_flown) {
  Cloud cloud({0.1, 0.08, 0.06}, 500, 1e-8, 3);
  add_sources(cloud, 4);
  const Vector3d force(0, 0.4, 0);
  auto stepper = make_stepper(over_floor(cloud, {.height = 5, .gravity = {0, 0, 0}},
                                         {push(force, {{0.012305, 0.023405, 0.034505}, {0, 1, 0}})}),
                              stepping(1e5, Rotation::finite, 100));
  const double impulse = 0.5 * 0.0222;
  int calls = 0;
  const Pose start = stepper->poses()[0];
  for (; stepper->steps() < 10'000; ++calls) ASSERT_EQ(stepper->step(), StepStatus::ok);
  // Flights over 12 samples, steps from 0.012 to 0.03451 s, and flights to 0.035 s and over 65 samples
  EXPECT_EQ(calls, 12 + 2251 + 1 + 65);
  const Pose end = stepper->poses()[0];
  EXPECT_LT((cloud.mass * end.velocity - impulse * force).norm(), 1e-13);
  // From the middle of the triangle on
  EXPECT_LT((cloud.mass * (end.position - start.position) - impulse * (0.1 - 0.023405) * force).norm(),
            1e-13);
  const Energy energy = stepper->modal()->energy();
  EXPECT_NEAR(energy.ledger(), 0, 1e-12 * energy.kinetic);
  EXPECT_NEAR(energy.kinetic + energy.strain, energy.loads, 1e-12 * energy.kinetic);
}

/// A box that has come to rest is lifted by a load of twice its weight.
TEST(TurningLoads, wake_a_body_that_rests) {
  Cloud box({0.05, 0.04, 0.03}, 2000, 1e-7, 8, true, 0);
  for (std::size_t n = 6; n < 81; ++n)
    box.kernel.modes.decay_rate[n] = 0.2 * box.kernel.modes.angular_frequency[n];
  add_sources(box, 4);
  box.kernel.applied[0].moment = values(cross_matrix(box.centre));
  const double weight = 9.81 * box.mass, rate = 5e4, begins = 2;
  auto stepper = make_stepper(over_floor(box, {.height = 1e-5, .friction = Friction{0.5, 0.5, 0}},
                                         {push({0, 0, 2 * weight}, {{begins}, {1}})}),
                              stepping(rate));
  Vector3d before = stepper->poses()[0].position;
  int still = 0;
  while (stepper->time() < begins - 0.5 / rate) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    still += stepper->poses()[0].position == before ? 1 : 0;
    before = stepper->poses()[0].position;
  }
  EXPECT_GT(still, 10'000) << "it sleeps";
  for (int k = 0; k < 5000; ++k) ASSERT_EQ(stepper->step(), StepStatus::ok);
  EXPECT_NEAR(stepper->poses()[0].position.z() - before.z(), 0.5 * 9.81 * 0.01, 0.05 * 0.5 * 9.81 * 0.01);
}

/// Tumbles on a floor under loads of both kinds: the ledger closes, and contact adds nothing.
TEST(TurningLoads, on_a_body_that_tumbles_close_the_ledger) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> spread(-1, 1);
  const auto any = [&] { return ricochet::test::drawn(spread, random); };
  int touches = 0;
  for (int scene = 0; scene < 8; ++scene) {
    Cloud cloud({0.1, 0.07, 0.04}, 1000, scene % 4 == 3 ? 0 : 1e-8, static_cast<unsigned>(100 + scene));
    add_sources(cloud, 3 * scene);
    Drop drop{
        .rotation = turn(3 * spread(random), any()), .velocity = any(), .spin = 20 * any(), .height = 0.01};
    if (scene % 2 == 0) drop.friction = Friction{0.5, 0.5, 0};
    const auto model = over_floor(cloud, drop,
                                  {push(5 * any(), {{0.003, 0.05, 0.0501}, {0, 1, 0.2}}),
                                   push(3 * any(), {{0}, {1}}, Axes::body), push(2 * any(), dead_load)});
    auto stepper = make_stepper(model, stepping(2e4 * (1 + scene)));
    const double start = stepper->modal()->energy().total();
    double scale = start;
#if RICOCHET_HEAP_COUNTED
    const long before = heap_counter::calls + heap_counter::returns;
#endif
    for (int k = 0; k < 3000; ++k) {
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      const Energy energy = stepper->modal()->energy();
      scale = std::max(scale, energy.kinetic + energy.strain + std::abs(energy.loads));
      ASSERT_LE(energy.total(), start + 1e-12 * scale) << scene << " " << k;
      ASSERT_NEAR(energy.ledger(), start, 1e-11 * scale) << scene << " " << k;
      touches += stepper->active() > 0;
    }
#if RICOCHET_HEAP_COUNTED
    EXPECT_EQ(heap_counter::calls + heap_counter::returns, before);
#endif
  }
  EXPECT_GT(touches, 100);
}

}  // namespace
}  // namespace ricochet::contact::test
