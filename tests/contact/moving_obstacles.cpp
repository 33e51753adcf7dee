// SPDX-License-Identifier: BSD-2-Clause
// Obstacles that move: what they do to bodies, and the work that they do.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "base/hdf5_reader.hpp"
#include "contact/api/scene_model.hpp"
#include "contact/figures/figure_observer.hpp"
#include "contact/figures/summary_observer.hpp"
#include "contact/files/motion_file.hpp"
#include "contact/pairing/rigid_surface.hpp"
#include "ricochet/ricochet.hpp"
#include "tests/contact/curved_bodies.hpp"
#include "tests/contact/plate.hpp"
#include "tests/contact/rigid_plate.hpp"
#include "tests/support.hpp"

namespace ricochet::moving_obstacles_test {

using Eigen::Vector3d;
using ricochet::test::complaint_of;

constexpr double mass = 0.03, radius = 0.01, g = 9.81;

SharedKernel a_ball() {
  static const SharedKernel kernel = contact::test::shared(contact::test::ball(mass, radius, 1e-8));
  return kernel;
}

Vector3 vector(const Vector3d& x) { return {x.x(), x.y(), x.z()}; }
Vector3d vector(const Vector3& x) { return {x[0], x[1], x[2]}; }

/// A ball and an obstacle that it may touch.
Scene scene_of(Obstacle obstacle, const Vector3& from, const Vector3& velocity, double rate) {
  obstacle.name = "paddle";
  Scene scene;
  scene.bodies = {{.name = "ball", .kernel = a_ball(), .translate = from, .velocity = velocity}};
  scene.obstacles = {std::move(obstacle)};
  scene.pairs = {{.a = "ball", .b = "paddle"}};
  scene.rotation = Rotation::finite;
  scene.rate_hz = rate;
  return scene;
}

/// What has come in beyond what is there or lost [J]: 0 if the ledger closes.
double surplus(const Simulation& simulation, double start) {
  const Energy now = simulation.energy();
  return start + now.loads - now.kinetic - now.strain - now.residual - now.damping - now.contact -
         now.friction;
}

double kinetic_of(const BodyMotion& motion) {
  return 0.5 * mass *
         (vector(motion.velocity).squaredNorm() + 0.4 * radius * radius * vector(motion.spin).squaredNorm());
}

Obstacle wall(Shape shape) {
  Obstacle out;
  out.shape = shape;
  if (shape == Shape::half_space) out.normal = {0, 0, 1};
  if (shape == Shape::box) {
    out.size = {0.3, 0.4, 0.1};
    out.point = {0.02, 0.01, -0.05};
  }
  if (shape == Shape::sphere) {
    out.radius = 0.05;
    out.point = {0.01, 0, -0.05};
  }
  return out;
}

/// By Galilei, a ball at rest that a moving wall hits moves like one that flies at a wall at rest, seen from
/// the wall. Steps end at the same times, so that only round-off differs: 1e-16 of a place of 0.1 m is 1e-9
/// of the indentation of 1e-7 m. A rate at which flights are crossed before and after checks that none is too
/// long.
TEST(MovingObstacles, hit_a_ball_as_it_hits_them) {
  const Vector3d wind(0.07, -0.03, 0.4), from(0, 0, radius + 3e-4);
  for (const Shape shape : {Shape::half_space, Shape::box, Shape::sphere})
    for (const bool rubs : {false, true}) {
      Scene still = scene_of(wall(shape), vector(from), vector(Vector3d(-wind)), 400'000),
            moving = scene_of(wall(shape), vector(from), {0, 0, 0}, 400'000);
      moving.obstacles[0].velocity = vector(wind);
      if (rubs)
        for (Scene* scene : {&still, &moving}) scene->pairs[0].friction = Friction{0.3, 0.3, 0};
      Simulation one(still), other(moving);
      const double start = one.energy().kinetic;
      ASSERT_EQ(one.step_block(2000).steps, 2000);
      ASSERT_EQ(other.step_block(2000).steps, 2000);
      const BodyMotion of_one = one.body_motion(0), of_other = other.body_motion(0);
      const std::string what = std::to_string(static_cast<int>(shape)) + (rubs ? " rubs" : "");
      EXPECT_GT(of_one.velocity[2], 0.2) << what;  // it has rebounded
      EXPECT_LT((vector(of_one.velocity) + wind - vector(of_other.velocity)).norm(), 1e-7) << what;
      EXPECT_LT((vector(of_one.spin) - vector(of_other.spin)).norm() * radius, 1e-7) << what;
      EXPECT_LT((vector(of_one.position) + one.time() * wind - vector(of_other.position)).norm(), 1e-9)
          << what;
      // The ledgers close, and without friction the wall has done what the ball has gained.
      EXPECT_LT(std::abs(surplus(one, start)), 1e-12) << what;
      EXPECT_LT(std::abs(surplus(other, 0)), 1e-12) << what;
      EXPECT_NEAR(other.energy().kinetic, kinetic_of(of_other), 1e-12) << what;
      EXPECT_EQ(one.energy().loads, 0) << what;
      if (!rubs) EXPECT_GT(other.energy().loads, 0.9 * other.energy().kinetic) << what;
    }
}

/// The same with linear rotations, in which the points keep their pairs.
TEST(MovingObstacles, hit_a_plate_that_does_not_turn_as_it_hits_them) {
  const Vector3d wind(0, 0, 0.1);
  for (const Shape shape : {Shape::half_space, Shape::box}) {
    const SharedKernel kernel = contact::test::plate({});
    Scene still;
    still.bodies = {{.name = "plate", .kernel = kernel, .translate = {0, 0, 1e-4}, .velocity = {0, 0, -0.1}}};
    still.obstacles = {wall(shape)};
    if (shape == Shape::box) {
      still.obstacles[0].size = {10, 10, 1};
      still.obstacles[0].point = {0, 0, -0.5};
    }
    still.obstacles[0].name = "floor";
    still.pairs = {{.a = "plate", .b = "floor", .direction = Vector3{0, 0, -1}}};
    still.rate_hz = 100'000;
    Scene moving = still;
    moving.bodies[0].velocity = {0, 0, 0};
    moving.obstacles[0].velocity = vector(wind);
    Simulation one(still), other(moving);
    const double start = one.energy().kinetic;
    ASSERT_EQ(one.step_block(1000).steps, 1000);
    ASSERT_EQ(other.step_block(1000).steps, 1000);
    EXPECT_GT(one.mean_velocity(0)[2], 0);
    EXPECT_NEAR(one.mean_velocity(0)[2] + 0.1, other.mean_velocity(0)[2], 1e-9);
    EXPECT_LT(std::abs(surplus(one, start)), 1e-12);
    EXPECT_LT(std::abs(surplus(other, 0)), 1e-12);
    EXPECT_GT(other.energy().loads, 0);
  }
}

/// A box that moves along its top speeds a plate up by μ g, as a belt does. The plate is laid on nine springs
/// at once, so that the force oscillates by its mean with ω = √(9/(R m)) = 3000 rad/s, and the speed by μ
/// g/ω.
TEST(MovingObstacles, carry_a_plate_along_by_friction) {
  constexpr double flexibility = 1e-6, time = 0.05, friction = 0.3;
  Scene scene;
  scene.bodies = {
      {.name = "plate", .kernel = contact::test::shared(contact::test::rigid_plate_on_springs(flexibility))}};
  scene.obstacles = {{.name = "floor",
                      .point = {0, 0, -0.5},
                      .velocity = {0.6, -0.8, 0},
                      .shape = Shape::box,
                      .size = {20, 20, 1}}};
  scene.pairs = {{.a = "plate", .b = "floor", .gap = 0.0, .friction = Friction{friction, friction, 0}}};
  scene.gravity = {0, 0, -g};
  Simulation simulation(scene);
  const auto steps = static_cast<std::int64_t>(time * scene.rate_hz);
  ASSERT_EQ(simulation.step_block(steps).steps, steps);
  const Vector3d velocity = vector(simulation.mean_velocity(0)), along(0.6, -0.8, 0);
  EXPECT_NEAR(velocity.dot(along), friction * g * time, 3 * friction * g / 3000);
  EXPECT_LT((velocity - velocity.dot(along) * along).norm(), 3 * friction * g / 3000);
}

/// A box turns about its middle at ω and hits a ball at rest at the distance r from its axis: without
/// friction and losses, the ball leaves along the normal with twice the speed ωr of the box there. In the
/// touch of 5e-5 s the box turns by 1e-3, and the ball moves along the face by as much of its way.
TEST(MovingObstacles, that_turn_throw_a_ball_with_twice_their_speed) {
  constexpr double spin = 20, arm = 0.08;
  Obstacle paddle;
  paddle.shape = Shape::box;
  paddle.size = {0.2, 0.02, 0.1};
  paddle.angular_velocity = {0, 0, spin};
  Scene scene = scene_of(paddle, {arm, 0.01 + radius + 1e-6, 0.003}, {}, 400'000);
  Simulation simulation(scene);
  ASSERT_EQ(simulation.step_block(200).steps, 200);
  const Vector3d velocity = vector(simulation.body_motion(0).velocity);
  EXPECT_EQ(simulation.active(), 0);
  EXPECT_NEAR(velocity.y(), 2 * spin * arm, 0.01 * 2 * spin * arm);
  EXPECT_LT(std::abs(velocity.x()), 0.01 * velocity.y());
  // The step in which the contact opens takes less than 1e-3 of the energy.
  EXPECT_NEAR(simulation.energy().loads, kinetic_of(simulation.body_motion(0)),
              1e-3 * simulation.energy().loads);
  EXPECT_LT(std::abs(surplus(simulation, 0)), 1e-12);
}

/// What a run of so many steps has found, from contact steps alone.
contact::ImpactFigures figures_of(const Scene& scene, int steps, bool& parted) {
  const auto model = std::make_shared<const contact::Model>(model_of(scene));
  const auto stepper = contact::make_stepper(model, step_options(scene));
  contact::FigureObserver observer(*model, stepper->options().step);
  for (int k = 0; k < steps && stepper->step() == StepStatus::ok; ++k) observer.observe(*stepper);
  parted = observer.parted(*stepper);
  return observer.figures();
}

/// Approach and restitution are those of a ball that flies at a wall at rest, by Galilei. A wall that turns
/// has the speed V + Ω × r of what the ball touches. A wall that is faster than the ball has not parted from
/// it, nor has one that turns.
TEST(MovingObstacles, count_with_their_speed_in_the_restitution) {
  constexpr double speed = 0.4;
  const Vector3 from = {0, 0, radius + 3e-4};
  bool parted = false;
  const auto still = figures_of(scene_of(wall(Shape::box), from, {0, 0, -speed}, 400'000), 2000, parted);
  EXPECT_TRUE(parted);
  Obstacle driven = wall(Shape::box);
  driven.velocity = {0, 0, speed};
  const auto moving = figures_of(scene_of(driven, from, {0, 0, 0}, 400'000), 2000, parted);
  EXPECT_TRUE(parted);
  ASSERT_TRUE(still.restitution && moving.restitution);
  EXPECT_GT(*still.restitution, 0.9);
  EXPECT_NEAR(*moving.restitution, *still.restitution, 1e-6);
  ASSERT_EQ(moving.episodes.size(), still.episodes.size());
  EXPECT_NEAR(moving.episodes[0].approach_m_per_s.value(), speed, 1e-9);

  // The ball rebounds at 2.8 m/s from a wall of 1.2 m/s, and is slower than it after 3.6 ms.
  driven.velocity = {0, 0, 3 * speed};
  Scene pushed = scene_of(driven, from, {0, 0, -speed}, 400'000);
  pushed.gravity = {0, 0, -450};
  figures_of(pushed, 2000, parted);
  EXPECT_FALSE(parted);

  Obstacle turning = wall(Shape::box);
  turning.velocity = {0, 0, speed};
  turning.angular_velocity = {1, 0, 0};
  const auto turned = figures_of(scene_of(turning, from, {0, 0, 0}, 400'000), 2000, parted);
  EXPECT_FALSE(parted);
  // The ball touches it 0.01 m from the axis of the turn, on the side that goes down, tilted by 1e-3. The
  // slope of a facet moves this place by 1e-4 m.
  EXPECT_NEAR(turned.episodes.at(0).approach_m_per_s.value(), speed - 0.01, 1e-4);
  EXPECT_NEAR(turned.restitution.value(), *still.restitution, 2e-3);
}

/// A box that turns hits a ball at rest at the distance r from its axis: the approach is ωr, and with a given
/// restitution e of the impulses, the ball leaves with (1 + e) ωr, which is e ωr relative to the box there.
TEST(MovingObstacles, that_turn_have_the_restitution_of_their_impulses) {
  constexpr double spin = 20, arm = 0.08, restitution = 0.6;
  Obstacle paddle;
  paddle.shape = Shape::box;
  paddle.size = {0.2, 0.02, 0.1};
  constexpr double turn_deg = 0.5;
  paddle.slides = {{{}, {0, turn_deg * std::numbers::pi / 180 / spin}, {0, 1}, Vector3{0, 0, turn_deg}}};
  Scene scene = scene_of(paddle, {arm, 0.01 + radius + 1e-6, 0.003}, {}, 400'000);
  scene.rotation = Rotation::linear;
  scene.scheme = Scheme::impulse;
  scene.restitution = restitution;
  bool parted = false;
  const auto figures = figures_of(scene, 100, parted);
  ASSERT_EQ(figures.episodes.size(), 1);
  // The slope of a facet of the ball moves its place by 1e-3 of the radius; the box turns by 1e-4.
  EXPECT_NEAR(figures.episodes[0].approach_m_per_s.value(), spin * arm, 1e-3 * spin * arm);
  EXPECT_NEAR(figures.restitution.value(), restitution, 1e-3);
  const double exit = figures.exit_velocity.at("ball").norm();
  EXPECT_NEAR(exit, (1 + restitution) * spin * arm, 2e-3 * spin * arm);
}

/// A wall of the speed V hits a plate at rest with the restitution e. Its impulse m (1 + e) V does the work m
/// (1 + e) V², of which the plate keeps m (1 + e)² V²/2: (1 − e)/2 of the work is lost.
TEST(MovingObstacles, put_in_the_energy_to_which_losses_are_relative) {
  constexpr double restitution = 0.6;
  Scene scene;
  kernels::Kernel plate = contact::test::rigid_plate();
  plate.body = "plate";
  scene.bodies = {{.name = "plate", .kernel = contact::test::shared(std::move(plate))}};
  scene.obstacles = {wall(Shape::half_space)};
  scene.obstacles[0].name = "wall";
  scene.obstacles[0].point = {0, 0, -1.5e-4};
  scene.obstacles[0].velocity = {0, 0, 0.1};
  scene.pairs = {{.a = "plate", .b = "wall", .direction = Vector3{0, 0, -1}}};
  scene.scheme = Scheme::impulse;
  scene.restitution = restitution;
  scene.rate_hz = 10'000;
  const auto model = std::make_shared<const contact::Model>(model_of(scene));
  const auto stepper = contact::make_stepper(model, step_options(scene));
  contact::SummaryObserver observer(*model, stepper->options().step, 0);
  for (int k = 0; k < 100; ++k) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    observer.observe(*stepper);
  }
  EXPECT_NEAR(observer.summary().energy_lost_contact.value(), (1 - restitution) / 2, 1e-9);
}

/// The same by a history that begins later, after flights: the box turns by ωt from t₀ on and meets the ball
/// when it has turned to it, by the angle at which the distance of the centre from the turned face is the
/// radius.
TEST(MovingObstacles, reach_a_ball_in_flight_at_the_time_of_their_histories) {
  constexpr double rate = 20'000, begins = 0.05, spin = 10, arm = 0.08, height = 0.03;
  Obstacle paddle;
  paddle.shape = Shape::box;
  paddle.size = {0.2, 0.02, 0.1};
  paddle.slides = {
      {.time = {begins, begins + 1}, .factor = {0, 1}, .turn_deg = {0, 0, spin * 180 / std::numbers::pi}}};
  Scene scene = scene_of(paddle, {arm, height, 0}, {}, rate);
  scene.contact_rate_hz = 10 * rate;
  Simulation simulation(scene);
  // y cos φ − x sin φ = 0.01 + radius
  double low = 0, high = 0.5;
  for (int k = 0; k < 60; ++k) {
    const double phi = 0.5 * (low + high);
    (height * std::cos(phi) - arm * std::sin(phi) > 0.01 + radius ? low : high) = phi;
  }
  const double expected = begins + low / spin;
  while (simulation.time() < 0.1 && simulation.contacts().empty())
    ASSERT_EQ(simulation.step(), StepStatus::ok);
  // The ball is a polyhedron of curved triangles: 1e-4 of its radius passes in 1e-6 s. A flight ends at a
  // sample.
  EXPECT_NEAR(simulation.time(), expected, 1.5 / rate);
  EXPECT_LT(simulation.steps(), 6000);
}

/// Heights of a ball over a plate that moves by A (1 − cos ωt), at most, in one period.
double highest(double acceleration) {
  constexpr double period = 0.1, omega = 2 * std::numbers::pi / period;
  const double amplitude = acceleration / (omega * omega);
  Obstacle plate = wall(Shape::half_space);
  Slide shakes{.vector = {0, 0, amplitude}};
  constexpr int knots = 2000;
  for (int k = 0; k <= knots; ++k) {
    shakes.time.push_back(period * k / knots);
    shakes.factor.push_back(1 - std::cos(omega * shakes.time.back()));
  }
  plate.slides = {shakes};
  Scene scene = scene_of(plate, {0, 0, radius + 1e-9}, {}, 20'000);
  scene.gravity = {0, 0, -g};
  Simulation simulation(scene);
  double most = 0;
  while (simulation.time() < period) {
    EXPECT_EQ(simulation.step(), StepStatus::ok);
    most = std::max(most, simulation.body_motion(0).position[2] - radius -
                              amplitude * (1 - std::cos(omega * simulation.time())));
  }
  return most;
}

/// The ball stays on the plate while its acceleration is below g. Above, it leaves when cos ωt = −g/(Aω²),
/// and flies like any stone. The history has kinks of 1e-3 of the largest speed, which let the ball hop by
/// 1e-6 m.
TEST(MovingObstacles, lose_what_they_shake_if_they_fall_faster_than_it) {
  EXPECT_LT(highest(0.8 * g), 2e-5);
  constexpr double omega = 2 * std::numbers::pi / 0.1, acceleration = 1.5 * g;
  const double amplitude = acceleration / (omega * omega), leaves = std::acos(-1 / 1.5) / omega,
               height = amplitude * (1 - std::cos(omega * leaves)),
               speed = amplitude * omega * std::sin(omega * leaves);
  double most = 0;
  for (int k = 0; k < 100'000; ++k) {
    const double t = leaves + 1e-6 * k, fall = 1e-6 * k;
    if (t > 0.1) break;
    most =
        std::max(most, height + speed * fall - 0.5 * g * fall * fall - amplitude * (1 - std::cos(omega * t)));
  }
  EXPECT_GT(most, 2e-4);
  EXPECT_NEAR(highest(acceleration), most, 0.05 * most);
}

/// A state of the middle of a motion goes on in another simulation to the last bit.
TEST(MovingObstacles, go_on_from_a_saved_state) {
  Obstacle paddle = wall(Shape::box);
  paddle.velocity = {0, 0, 0.4};
  paddle.angular_velocity = {1, 0, 0};
  const Scene scene = scene_of(paddle, {0, 0, radius + 1e-5}, {}, 100'000);
  Simulation one(scene), other(scene);
  ASSERT_EQ(one.step_block(5).steps, 5);
  ASSERT_TRUE(other.restore(one.save()));
  const auto state = other.state(one.save().bytes());
  Simulation third(scene);
  ASSERT_TRUE(third.restore(state));
  for (Simulation* each : {&one, &other, &third}) ASSERT_EQ(each->step_block(100).steps, 100);
  EXPECT_GT(one.body_motion(0).velocity[2], 0.4);
  for (Simulation* each : {&other, &third})
    EXPECT_EQ(one.body_motion(0).velocity, each->body_motion(0).velocity);
}

/// A box that turns about the z axis and a floor that rises, in the frames for ParaView.
TEST(MovingObstacles, are_shown_where_they_are) {
  kernels::Kernel seen = contact::test::ball(mass, radius, 1e-8);
  kernels::View& view = seen.view.emplace();
  view.node = seen.surface.node;
  view.element = seen.surface.element;
  view.shape.assign(seen.surface.shape.begin(), seen.surface.shape.end());
  Obstacle paddle = wall(Shape::box);
  paddle.angular_velocity = {0, 0, 2};
  Scene scene = scene_of(paddle, {0, 0, 0.1}, {}, 1000);
  scene.bodies[0].kernel = contact::test::shared(std::move(seen));
  scene.obstacles.push_back(
      {.name = "floor", .point = {0, 0, -1}, .normal = {0, 0, 1}, .velocity = {0, 0, 0.1}});
  scene.pairs.push_back({.a = "ball", .b = "floor"});
  const contact::Model model = model_of(scene);
  const auto stepper = contact::make_stepper(model, step_options(scene));
  const ricochet::test::Folder folder;
  contact::MotionFile file(*stepper, model, {.stem = folder / "m", .pairs = {"on paddle", "on floor"}});
  while (stepper->time() < 0.0499) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    file.record(*stepper);
  }
  file.commit();
  const base::hdf5::Reader read(folder / "m.h5", "");
  constexpr double angle = 0.1;  // 2 rad/s for 0.05 s
  const Vector3d middle(0.02, 0.01, -0.05);
  const std::size_t nodes = contact::rigid_box({0.3, 0.4, 0.1}, false).node.size();
  const auto before = read.read<double>("/obstacles/1/position/000000", {nodes, 3}),
             after = read.read<double>("/obstacles/1/position/000050", {nodes, 3});
  for (std::size_t i = 0; i < before.size(); i += 3) {
    const Vector3d x = Vector3d(before[i], before[i + 1], before[i + 2]) - middle;
    // On one of its faces
    EXPECT_NEAR((x.cwiseAbs() - Vector3d(0.15, 0.2, 0.05)).maxCoeff(), 0, 1e-12);
    EXPECT_NEAR(after[i], middle.x() + std::cos(angle) * x.x() - std::sin(angle) * x.y(), 1e-12);
    EXPECT_NEAR(after[i + 1], middle.y() + std::sin(angle) * x.x() + std::cos(angle) * x.y(), 1e-12);
    EXPECT_NEAR(after[i + 2], before[i + 2], 1e-12);
  }
  const auto floor = read.read<double>("/obstacles/2/position/000050", {4, 3});
  for (std::size_t i = 2; i < 12; i += 3) EXPECT_NEAR(floor[i], -1 + 0.1 * 0.05, 1e-12);
  EXPECT_GT(std::abs(floor[0] - floor[6]), 2 * radius);  // it is seen beside the ball
  std::ifstream text(folder / "m.xdmf");
  const std::string xdmf(std::istreambuf_iterator<char>(text), {});
  EXPECT_NE(xdmf.find("\"paddle\""), std::string::npos);
  EXPECT_NE(xdmf.find("/obstacles/1/position/000050"), std::string::npos);
}

TEST(MovingObstacles, refuse_motions_that_they_cannot_make) {
  const auto complaint = [](Shape shape, auto change) {
    Scene scene = scene_of(wall(shape), {0, 0, radius + 1e-4}, {}, 100'000);
    change(scene);
    return complaint_of([&] { Simulation made(scene); });
  };
  EXPECT_EQ(complaint(Shape::half_space,
                      [](Scene& s) {
                        s.obstacles[0].angular_velocity = {1, 0, 0};
                      }),
            "obstacles.paddle: a half-space does not turn. Give a box that is large enough.");
  EXPECT_EQ(complaint(Shape::box,
                      [](Scene& s) {
                        s.obstacles[0].angular_velocity = {1, 0, 0};
                        s.obstacles[0].slides = {{.time = {0, 1}, .factor = {0, 1}, .turn_deg = {0, 1, 0}}};
                      }),
            "obstacles.paddle: it turns about two axes. Give all its turns the same one.");
  EXPECT_EQ(complaint(Shape::sphere,
                      [](Scene& s) {
                        s.obstacles[0].slides = {{.vector = {1, 0, 0}, .time = {-1, 1}, .factor = {0, 1}}};
                      }),
            "obstacles.paddle: its factor at t = 0 is 0.5, so it would not begin at its point. Begin with a "
            "factor of "
            "0, and move the point.");
  EXPECT_EQ(complaint(Shape::sphere,
                      [](Scene& s) {
                        s.rotation = Rotation::linear;
                        s.obstacles[0].slides = {{.time = {0, 1}, .factor = {0, 2}, .turn_deg = {1, 0, 0}}};
                      }),
            "obstacles.paddle: it turns by 2 degrees, and with linear rotations points keep their pairs, "
            "which hold "
            "for 1. Set motion.rotation = \"finite\", or turn it less.");
}

}  // namespace ricochet::moving_obstacles_test
