// SPDX-License-Identifier: BSD-2-Clause
// Obstacles with surfaces: their closed forms, gaps of bodies to them, and bodies that roll, slide and bounce
// on and in them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "contact/pairing/rigid_surface.hpp"
#include "ricochet/ricochet.hpp"
#include "tests/contact/curved_bodies.hpp"
#include "tests/contact/plate.hpp"
#include "tests/drawn.hpp"

namespace ricochet::contact::test {
namespace obstacles_test {

constexpr double g = 9.81;
const Vector3d up = Vector3d::UnitZ();

Obstacle solid(WorldSurface surface, const Vector3d& point = Vector3d::Zero(),
               const Matrix3d& rotation = Matrix3d::Identity()) {
  return {.name = "floor",
          .point = point,
          .surface = std::make_shared<const WorldSurface>(std::move(surface)),
          .rotation = rotation};
}

using Form = RoundSurface::Form;

WorldSurface sphere(double radius, bool inside = false) {
  return rigid_surface(RoundSurface{.form = Form::capsule, .radius = radius, .side = inside ? -1.0 : 1.0});
}
WorldSurface cylinder(double radius, double length, bool inside = false) {
  return rigid_surface(RoundSurface{.form = Form::cone,
                                    .radius = radius,
                                    .radius_small = radius,
                                    .length = length,
                                    .side = inside ? -1.0 : 1.0});
}

/// A shape, and its signed distance from the textbook (positive outside).
struct Named {
  std::string name;
  WorldSurface surface;
  std::function<double(const Vector3d&)> distance;
};

/// Distance of a point in the plane from a segment.
double from_segment(const Eigen::Vector2d& x, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const double s = std::clamp((x - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (x - a - s * (b - a)).norm();
}

/// Of a solid of revolution about z with the profile (0, low), (r, low), (s, high), (0, high).
double from_frustum(const Vector3d& x, double r, double s, double half) {
  const Eigen::Vector2d at(std::hypot(x.x(), x.y()), x.z());
  const double outline =
      std::min({from_segment(at, {0, -half}, {r, -half}), from_segment(at, {r, -half}, {s, half}),
                from_segment(at, {s, half}, {0, half})});
  const double width = r + (s - r) * (at.y() + half) / (2 * half);
  return std::abs(at.y()) < half && at.x() < width ? -outline : outline;
}

std::vector<Named> shapes() {
  const Vector3d edges(0.3, 0.2, 0.5);
  return {
      {"sphere", sphere(0.2), [](const Vector3d& x) { return x.norm() - 0.2; }},
      {"capsule", rigid_surface(RoundSurface{.form = Form::capsule, .radius = 0.1, .length = 0.3}),
       [](const Vector3d& x) { return (x - Vector3d(0, 0, std::clamp(x.z(), -0.15, 0.15))).norm() - 0.1; }},
      {"torus", rigid_surface(RoundSurface{.form = Form::torus, .radius = 0.3, .radius_small = 0.1}),
       [](const Vector3d& x) { return std::hypot(std::hypot(x.x(), x.y()) - 0.3, x.z()) - 0.1; }},
      {"cylinder", cylinder(0.2, 0.4), [](const Vector3d& x) { return from_frustum(x, 0.2, 0.2, 0.2); }},
      {"cone", rigid_surface(RoundSurface{.form = Form::cone, .radius = 0.2, .length = 0.4}),
       [](const Vector3d& x) { return from_frustum(x, 0.2, 0, 0.2); }},
      {"frustum",
       rigid_surface(RoundSurface{.form = Form::cone, .radius = 0.1, .radius_small = 0.2, .length = 0.4}),
       [](const Vector3d& x) { return from_frustum(x, 0.1, 0.2, 0.2); }},
      {"box", rigid_box(edges, false),
       [edges](const Vector3d& x) {
         const Vector3d beyond = x.cwiseAbs() - edges / 2;
         return beyond.cwiseMax(0).norm() + std::min(0.0, beyond.maxCoeff());
       }},
  };
}

/// Near a surface, the closest point is as far as the distance of the textbook says: to round-off, but for
/// rims. There, the place along an arc of 5.6° is that of its chord: up to 7e-5 m aside, which is 5e-6 m more
/// at a distance of 5e-4 m.
TEST(Obstacles, are_at_the_distance_of_their_closed_forms) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> spread(-0.5, 0.5);
  for (const Named& shape : shapes()) {
    const SurfaceProjection onto(shape.surface);
    int smooth = 0;
    for (int k = 0; k < 3000; ++k) {
      const Vector3d x = ricochet::test::drawn(spread, random);
      const double distance = shape.distance(x);
      if (std::abs(distance) > 0.02) continue;  // farther inside, other chords may be nearer
      const auto found = onto.closest(x);
      ASSERT_TRUE(found);
      EXPECT_NEAR((found->point - x).norm(), std::abs(distance), 1e-5) << shape.name;
      EXPECT_NEAR(shape.distance(found->point), 0, 1e-6) << shape.name;
      if (std::abs(shape.distance(found->point)) > 1e-14) continue;
      ++smooth;
      const Vector3d way = x - found->point;
      if (std::abs(found->normal.dot(way)) < (1 - 1e-10) * way.norm()) continue;  // beyond a rim
      EXPECT_NEAR(found->normal.dot(way), distance, 1e-14) << shape.name;
    }
    EXPECT_GT(smooth, 20) << shape.name;
  }
}

/// n(x + dx) − n(x) = W dx, to the second order of dx.
TEST(Obstacles, have_the_curvature_by_which_their_normals_turn) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> spread(-0.4, 0.4);
  constexpr double step = 1e-5;
  for (const RoundSurface& round :
       {RoundSurface{.form = Form::capsule, .radius = 0.1, .length = 0.3},
        RoundSurface{.form = Form::capsule, .radius = 0.2, .side = -1},
        RoundSurface{.form = Form::torus, .radius = 0.3, .radius_small = 0.1},
        RoundSurface{.form = Form::torus, .radius = 0.3, .radius_small = 0.1, .side = -1},
        RoundSurface{.form = Form::cone, .radius = 0.1, .radius_small = 0.3, .length = 0.4}}) {
    for (int k = 0; k < 200; ++k) {
      const auto at = round.closest(ricochet::test::drawn(spread, random));
      if (std::abs(std::abs(at.point.z()) - 0.15) < 1e-3) continue;  // where a capsule's curvature jumps
      Vector3d way = step * ricochet::test::drawn(spread, random);
      way -= way.dot(at.normal) * at.normal;
      const auto there = round.closest(at.point + way);
      EXPECT_LT((there.normal - at.normal - at.curvature * (there.point - at.point)).norm(),
                1e-2 * (way.norm() / 0.1));
      EXPECT_LT((at.curvature * at.normal).norm(), 1e-12);
    }
  }
}

/// All corners of a unit cube, as a mesh, and what is wrong without one triangle.
TEST(Obstacles, of_meshes_must_be_closed) {
  RigidMesh mesh;
  for (int k = 0; k < 8; ++k) mesh.node.emplace_back(k & 1, k >> 1 & 1, k >> 2);
  mesh.triangle = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  EXPECT_EQ(flaw_of(mesh), "");
  const WorldSurface cube = rigid_surface(mesh);
  EXPECT_EQ(cube.crease.size(), 12U);
  RigidMesh turned = mesh;
  for (auto& t : turned.triangle) std::swap(t[0], t[1]);
  EXPECT_EQ(flaw_of(turned), "");
  auto rotated = mesh.triangle;  // the same triangles begin at another corner
  for (auto& t : rotated) t = std::array{t[1], t[2], t[0]};
  EXPECT_EQ(turned.triangle, rotated);
  mesh.triangle.pop_back();
  EXPECT_NE(flaw_of(mesh).find("is not closed at [1, "), std::string::npos) << flaw_of(mesh);
  mesh.triangle.push_back({3, 7, 8});
  EXPECT_NE(flaw_of(mesh).find("node 8, but 8 nodes"), std::string::npos) << flaw_of(mesh);
}

/// Of the candidates of a ball over each side of a sphere: y is the closest point of the sphere.
TEST(Obstacles, are_met_at_their_closest_points) {
  const kernels::Kernel kernel = ball(1, 0.1, 1e-9);
  for (const bool inside : {false, true}) {
    const double radius = 0.3, away = inside ? 0.19 : 0.41;
    const Vector3d centre(0.2, -0.1, 0.3);
    const PlacedBody body{.name = "body", .kernel = &kernel, .translation = centre + away * up};
    const Pairing pairing = pair(body, solid(sphere(radius, inside), centre), {"body", "floor", {}, {}, {}});
    ASSERT_GT(pairing.points.size(), 20U);
    double least = 1;
    for (const Pairing::Point& point : pairing.points) {
      EXPECT_TRUE(point.of_b.empty());
      const Vector3d out = (inside ? -1 : 1) * (point.b - centre) / radius;
      EXPECT_NEAR(out.norm(), 1, 1e-13);
      EXPECT_LT((point.normal + out).norm(), 1e-12);
      EXPECT_NEAR(point.gap, std::abs((point.a - centre).norm() - radius), 1e-15);
      EXPECT_NEAR(point.gap, point.normal.dot(point.b - point.a), 1e-15);
      least = std::min(least, point.gap);
    }
    // The nearest candidate is up to half an element, 0.15 r, aside: (1/r ∓ 1/R) (0.15 r)²/2
    EXPECT_GT(least, 0.01 - 1e-12);
    EXPECT_LT(least, 0.01 + (1 / 0.1 + (inside ? -1 : 1) / radius) * 0.015 * 0.015 / 2);
  }
}

/// A ball over an obstacle, with finite rotations.
std::shared_ptr<const Model> over(const kernels::Kernel& kernel, const Obstacle& obstacle, PlacedBody body,
                                  const Vector3d& gravity, const std::optional<Friction>& friction = {}) {
  body.name = "body";
  body.kernel = &kernel;
  PairRequest pair{"body", "floor", {}, {}, {}};
  pair.friction = friction;
  pair.everywhere = true;
  return std::make_shared<const Model>(build_model({body}, {obstacle}, {pair}, gravity));
}

constexpr double mass = 0.03, radius = 0.01, flexibility = 1e-8;

/// Period of small oscillations, from the passages of the lowest place.
double period_of(Stepper& stepper, double until, Eigen::Index axis) {
  std::vector<double> passed;
  double before = stepper.poses()[0].position(axis), then = stepper.time();
  while (stepper.time() < until) {
    if (stepper.step() != StepStatus::ok) return 0;
    const double now = stepper.poses()[0].position(axis);
    if (now * before < 0) passed.push_back(then + (stepper.time() - then) * before / (before - now));
    before = now;
    then = stepper.time();
  }
  return passed.size() < 2 ? 0
                           : 2 * (passed.back() - passed.front()) / static_cast<double>(passed.size() - 1);
}

/// A pendulum of the length R − r swings with 2π √((R − r)/g (1 + A²/16)) at a small amplitude A; rolling
/// takes 7/5 of the mass along. The surface of the ball ripples by 2e-5 of its radius, the curvature by 1 %:
/// where it touches, the ball is higher or lower by 2e-7 m, against 5e-5 m of the amplitude.
TEST(Obstacles, make_a_bowl_in_which_a_ball_swings_like_a_pendulum) {
  const double bowl = 0.05, amplitude = 0.2, length = bowl - radius;
  const kernels::Kernel kernel = ball(mass, radius, flexibility);
  const double pendulum = 2 * std::numbers::pi * std::sqrt(length / g) * (1 + amplitude * amplitude / 16);
  const auto period = [&](const Obstacle& obstacle, const std::optional<Friction>& friction) {
    PlacedBody body;
    body.translation = length * (1 - 1e-6) * Vector3d(std::sin(amplitude), 0, -std::cos(amplitude));
    auto stepper = make_stepper(over(kernel, obstacle, body, {0, 0, -g}, friction), stepping(10'000));
    return period_of(*stepper, 0.6, 0);
  };
  const Friction rough{0.5, 0.5, 0};
  EXPECT_NEAR(period(solid(sphere(bowl, true)), {}) / pendulum, 1, 5e-3);
  EXPECT_NEAR(period(solid(sphere(bowl, true)), rough) / (std::sqrt(1.4) * pendulum), 1, 5e-3);
  // Across a horizontal tube, it is the same.
  EXPECT_NEAR(period(solid(cylinder(bowl, 0.2, true), Vector3d::Zero(),
                           turn(std::numbers::pi / 2, Vector3d::UnitX())),
                     rough) /
                  (std::sqrt(1.4) * pendulum),
              1, 5e-3);
}

/// The sphere of 162 nodes as a mesh: its curved triangles err by 6e-5 of the radius, and their slope by
/// 2e-3.
TEST(Obstacles, of_a_mesh_of_a_sphere_move_a_ball_like_the_sphere) {
  const double bowl = 0.05, amplitude = 0.2, length = bowl - radius;
  const Sphere drawing = unit_sphere();
  RigidMesh mesh{.triangle = drawing.triangles, .inside = true};
  for (const Vector3d& x : drawing.node) mesh.node.push_back(bowl * x);
  const kernels::Kernel kernel = ball(mass, radius, flexibility);
  PlacedBody body;
  body.translation = length * (1 - 2e-3) * Vector3d(std::sin(amplitude), 0, -std::cos(amplitude));
  auto stepper = make_stepper(
      over(kernel, solid(rigid_surface(mesh)), body, {0, 0, -g}, Friction{0.5, 0.5, 0}), stepping(20'000));
  const double pendulum =
      2 * std::numbers::pi * std::sqrt(1.4 * length / g) * (1 + amplitude * amplitude / 16);
  EXPECT_NEAR(period_of(*stepper, 0.9, 0) / pendulum, 1, 0.02);
}

/// The top of a box is a half-space to what stays over it. Over a half-space, the summit of a ball is its
/// highest point; over a face, it is where the normals face each other, up to 2e-3 of the radius aside on
/// triangles.
TEST(Obstacles, that_are_boxes_act_by_their_faces_like_half_spaces) {
  const kernels::Kernel kernel = ball(mass, radius, 1e-7);
  PlacedBody body{.translation = {0.013, 0.007, 0.02}, .velocity = {0.1, 0.02, 0}};
  const Friction rough{0.3, 0.3, 0};
  const Obstacle plane{.name = "floor", .normal = up};
  const auto over_box =
      over(kernel, solid(rigid_box({0.4, 0.3, 0.1}, false), {0, 0, -0.05}), body, {0, 0, -g}, rough);
  auto flat = make_stepper(over(kernel, plane, body, {0, 0, -g}, rough), stepping(20'000)),
       box = make_stepper(over_box, stepping(20'000));
  double deepest = -1;
  while (flat->time() < 0.12) {
    ASSERT_EQ(flat->step(), StepStatus::ok);
    while (box->time() < flat->time() - 1e-9) {
      ASSERT_EQ(box->step(), StepStatus::ok);
      deepest = std::max(deepest, (box->displacement().head(over_box->points()) - over_box->gap).maxCoeff());
    }
  }
  // No point counts as deep in the box because it is behind the far side, 0.1 m below.
  EXPECT_LT(deepest, 1e-3 * radius);
  const Pose one = flat->poses()[0], other = box->poses()[0];
  EXPECT_GT(std::abs(one.spin.y()) * radius, 0.05);  // it has touched
  EXPECT_LT((one.position - other.position).norm(), 5e-3 * radius);
  EXPECT_LT((one.velocity - other.velocity).norm(), 1e-2);
}

/// A soft ball whose patches bulge lands slanted, on many of them at once: on the face of a box as on a
/// half-space. Only the round-off of places of 0.1 m differs, 1e-17 m, which 600 steps raise to 1e-9 of the
/// speed at most.
TEST(Obstacles, that_are_boxes_bear_the_bulges_of_patches_like_half_spaces) {
  const kernels::Kernel kernel = ball(mass, radius, 6e-5, 1.1e-4);
  const PlacedBody body{.translation = {0.013, 0.007, radius + 1e-5}, .velocity = {0.3, 0.1, -1}};
  const Friction rough{0.3, 0.3, 0};
  const auto land = [&](const Obstacle& floor, int& most) {
    auto stepper = make_stepper(over(kernel, floor, body, Vector3d::Zero(), rough), stepping(50'000));
    while (stepper->time() < 0.012) {
      EXPECT_EQ(stepper->step(), StepStatus::ok);
      most = std::max(most, stepper->active());
    }
    EXPECT_EQ(stepper->active(), 0);
    return stepper->poses()[0];
  };
  int over_plane = 0, over_box = 0;
  const Pose plane = land({.name = "floor", .normal = up}, over_plane),
             box = land(solid(rigid_box({0.4, 0.3, 0.1}, false), {0, 0, -0.05}), over_box);
  EXPECT_GT(over_plane, 3);
  EXPECT_EQ(over_plane, over_box);
  EXPECT_GT(plane.velocity.z(), 0.9);
  EXPECT_LT((plane.velocity - box.velocity).norm(), 1e-9);
  EXPECT_LT((plane.spin - box.spin).norm() * radius, 1e-9);
}

/// The impulse on a ball without friction that hits an edge leads from the edge to its centre.
TEST(Obstacles, push_a_ball_away_from_their_edges) {
  const kernels::Kernel kernel = ball(mass, radius, 1e-7);
  const double aside = 0.4 * radius;
  // The box ends at x = 0, and its top is at z = 0.
  const Obstacle box = solid(rigid_box({0.2, 0.3, 0.1}, false), {-0.1, 0, -0.05});
  const Vector3d centre(aside, 0.011, std::sqrt(radius * radius - aside * aside) + 1e-4);
  PlacedBody body{.translation = centre, .velocity = {0, 0, -0.5}};
  auto stepper = make_stepper(over(kernel, box, body, Vector3d::Zero()), stepping(200'000));
  while (stepper->time() < 2e-3) ASSERT_EQ(stepper->step(), StepStatus::ok);
  const Vector3d impulse = stepper->poses()[0].velocity - body.velocity;
  const Vector3d along = (centre - Vector3d(0, 0.011, 0) - 1e-4 * up).normalized();
  EXPECT_GT(impulse.norm(), 0.4);
  // A facet of the ball is 0.3 r wide, with slopes beside its normals of about 1e-3.
  EXPECT_LT((impulse.normalized() - along).norm(), 0.02);
  EXPECT_NEAR(impulse.norm(), 2 * 0.5 * along.z(), 0.02);  // elastic: twice the speed along the line
}

/// Balls that fly about within each shape, and hit its outside, keep their energy: contact never adds any,
/// and what it takes is of the second order of the step.
TEST(Obstacles, take_no_energy_from_balls_without_friction) {
  const kernels::Kernel kernel = ball(mass, radius, 1e-7);
  struct Flight {
    std::string name;
    WorldSurface surface;
    Vector3d from, velocity;
  };
  const Vector3d slanted(0.6, 0.35, 0.5);
  for (const Flight& flight : {
           Flight{"bowl", sphere(0.03, true), {0.002, 0.001, 0}, slanted},
           Flight{"tube", cylinder(0.03, 0.08, true), {0.002, 0.001, 0}, slanted},
           Flight{"case", rigid_box({0.05, 0.06, 0.07}, true), {0, 0, 0}, slanted},
           Flight{"funnel",
                  rigid_surface(RoundSurface{
                      .form = Form::cone, .radius = 0.03, .radius_small = 0.06, .length = 0.08, .side = -1}),
                  {0.002, 0.001, 0},
                  slanted},
           Flight{"ring inside",
                  rigid_surface(
                      RoundSurface{.form = Form::torus, .radius = 0.06, .radius_small = 0.025, .side = -1}),
                  {0.06, 0, 0},
                  slanted},
           Flight{"ball", sphere(0.03), {0.004, 0.003, 0.045}, {0, 0, -0.8}},
           Flight{"pin",
                  rigid_surface(RoundSurface{.form = Form::capsule, .radius = 0.01, .length = 0.04}),
                  {0.03, 0.002, 0.01},
                  {-0.8, 0, 0}},
           Flight{"spike",
                  rigid_surface(RoundSurface{.form = Form::cone, .radius = 0.02, .length = 0.04}),
                  {0.003, 0.001, 0.04},
                  {0, 0, -0.8}},
           Flight{"ring",
                  rigid_surface(RoundSurface{.form = Form::torus, .radius = 0.03, .radius_small = 0.01}),
                  {0.033, 0.001, 0.03},
                  {0, 0, -0.8}},
           Flight{"rod", cylinder(0.01, 0.08), {0.03, 0.002, 0.01}, {-0.8, 0, 0}},
       }) {
    PlacedBody body{.translation = flight.from, .velocity = flight.velocity};
    auto stepper =
        make_stepper(over(kernel, solid(flight.surface), body, Vector3d::Zero()), stepping(50'000));
    const double start = stepper->modal()->energy().kinetic;
    double touching = 0, most = 0;
    while (stepper->time() < 0.1) {
      ASSERT_EQ(stepper->step(), StepStatus::ok) << flight.name;
      touching += stepper->active() > 0 ? 1 : 0;
      most = std::max(most, stepper->modal()->energy().kinetic);
    }
    EXPECT_GT(touching, 0) << flight.name;
    EXPECT_LT(most, (1 + 1e-9) * start) << flight.name;
    EXPECT_GT(stepper->modal()->energy().kinetic, 0.96 * start) << flight.name;
    // Those inside cannot leave; the others fly off again by 0.05 m or more.
    const double far = stepper->poses()[0].position.norm();
    if (flight.surface.normal[0].dot(flight.surface.node[0]) < 0)
      EXPECT_LT(far, 0.09) << flight.name;
    else
      EXPECT_GT(far, 0.05) << flight.name;
  }
}

}  // namespace obstacles_test
}  // namespace ricochet::contact::test

namespace obstacles_of_library_test {

using namespace ricochet;
using ricochet::test::complaint_of;

/// A ball that lies in a bowl, off its middle.
Scene ball_in_bowl(const ricochet::SharedKernel& kernel) {
  Scene scene;
  scene.bodies = {{.name = "ball", .kernel = kernel, .translate = {0.01, 0, -0.038}}};
  ricochet::Obstacle bowl{.name = "bowl", .point = {0, 0, 0}};
  bowl.shape = Shape::sphere;
  bowl.side = ObstacleSide::inside;
  bowl.radius = 0.05;
  scene.obstacles = {bowl};
  scene.pairs = {{.a = "ball", .b = "bowl"}};
  scene.rotation = Rotation::finite;
  scene.rate_hz = 20'000;
  scene.gravity = {0, 0, -9.81};
  return scene;
}

TEST(Obstacles, of_the_library_refuse_wrong_sizes_in_one_line) {
  const SharedKernel kernel =
      contact::test::shared(contact::test::ball(contact::test::obstacles_test::mass, 0.01, 1e-8));
  const auto complaint = [&](auto change) {
    Scene scene = ball_in_bowl(kernel);
    change(scene.obstacles[0]);
    return complaint_of([&] { Simulation made(scene); });
  };
  EXPECT_EQ(complaint([](auto& one) { one.radius = 0; }), "obstacles.bowl.radius = 0: must be above 0.");
  EXPECT_EQ(complaint([](auto& one) { one.shape = Shape::capsule; }),
            "obstacles.bowl.length = 0: must be above 0.");
  EXPECT_EQ(complaint([](auto& one) {
              one.shape = Shape::torus;
              one.radius_small = 0.06;
            }),
            "obstacles.bowl.radius = 0.05: must be above radius_small, or the tube would cross itself.");
  EXPECT_EQ(complaint([](auto& one) { one.shape = Shape::mesh; }),
            "obstacles.bowl: its surface has no triangles. Give a closed surface.");
  const std::string deep = complaint([](auto& one) { one.point = {0, 0, 0.01}; });
  EXPECT_NE(deep.find("they overlap by 0.00"), std::string::npos) << deep;
}

TEST(Obstacles, of_the_library_hold_a_body_in_a_bowl) {
  const SharedKernel kernel =
      contact::test::shared(contact::test::ball(contact::test::obstacles_test::mass, 0.01, 1e-8));
  Simulation simulation(ball_in_bowl(kernel));
  double lowest = 0;
  for (int k = 0; k < 4000; ++k) {
    ASSERT_EQ(simulation.step(), StepStatus::ok);
    for (const ricochet::Touching& touch : simulation.contacts()) EXPECT_EQ(touch.between[1], "bowl");
    const ricochet::Vector3 at = simulation.body_motion(0).position;
    lowest = std::min(lowest, at[2]);
    // Its surface ripples by 2e-5 of the radius, and it hops by its fall of 1 mm at first.
    EXPECT_LT(std::hypot(at[0], at[1], at[2]), 0.04 + 1e-5);
  }
  EXPECT_NEAR(lowest, -0.04, 1e-4);
}

}  // namespace obstacles_of_library_test
