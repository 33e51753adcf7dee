// SPDX-License-Identifier: BSD-2-Clause
// Bodies with curved surfaces that roll on a floor, on contact points that move along them.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "contact/motion/body_surface.hpp"
#include "kernels/compression.hpp"
#include "tests/contact/curved_bodies.hpp"
#include "tests/drawn.hpp"

namespace ricochet::contact::test {
namespace rolling_test {

constexpr double g = 9.81;

/// An ellipsoid with its centre at a height above its centre of mass and its axes turned about the vertical
/// from the principal axes of inertia, which are x, y and z.
struct Ellipsoid {
  double mass;
  Vector3d moments, axes;
  double height, turned;

  Matrix3d own_axes() const { return turn(turned, Vector3d::UnitZ()); }

  /// Its nodes are densest below.
  kernels::Kernel kernel(double flexibility) const {
    const auto on_sphere = [](const Vector3d& x) -> Vector3d {
      return (x - 0.8 * Vector3d::UnitZ()).normalized();
    };
    return deformed_sphere(
        mass, moments,
        [&](const Vector3d& x) -> Vector3d {
          return own_axes() * axes.cwiseProduct(on_sphere(x)) + height * Vector3d::UnitZ();
        },
        [&](const Vector3d& x) -> Vector3d {
          return own_axes() * on_sphere(x).cwiseQuotient(axes).normalized();
        },
        flexibility, axes.minCoeff(), 0);
  }
};

/// Adds an elastic mode to a body. @param displacement  of each candidate
template <class Displacement>
void add_mode(kernels::Kernel& kernel, double omega, Displacement displacement) {
  kernel.modes.angular_frequency.push_back(omega);
  kernel.modes.decay_rate.push_back(0);
  const auto modes = std::ssize(kernel.modes.angular_frequency);
  const auto widen = [&](std::vector<double>& rows, auto value) {
    std::vector<double> wide;
    for (std::ptrdiff_t row = 0; row * (modes - 1) < std::ssize(rows); ++row) {
      const auto first = rows.begin() + row * (modes - 1);
      wide.insert(wide.end(), first, first + modes - 1);
      wide.push_back(value(row));
    }
    rows = wide;
  };
  widen(kernel.surface.shape,
        [&](std::ptrdiff_t row) { return displacement(static_cast<std::size_t>(row / 3))(row % 3); });
  for (std::vector<double>* rows : {&kernel.loads.body_force, &kernel.loads.rotation})
    widen(*rows, [](std::ptrdiff_t) { return 0.0; });
}

/// The surface of a ball seen from within.
kernels::Kernel cavity(double mass, double radius, double flexibility) {
  kernels::Kernel kernel = ball(mass, radius, flexibility);
  kernels::Surface& surface = kernel.surface;
  for (std::size_t first = 0; first < surface.element.size(); first += 3) {
    std::swap(surface.element[first + 1], surface.element[first + 2]);
    for (std::size_t axis = 0; axis < 3; ++axis)
      std::swap(surface.element_normal[3 * (first + 1) + axis],
                surface.element_normal[3 * (first + 2) + axis]);
  }
  for (double& n : surface.element_normal) n = -n;
  return kernel;
}

/// A disk with 32 nodes on each rim, whose axis is z.
kernels::Kernel disk(double mass, double radius, double height, double flexibility) {
  constexpr int parts = 32;
  std::vector<Vector3d> node;
  const auto around = [](int k) {
    const double angle = 2 * std::numbers::pi * k / parts;
    return Vector3d(std::cos(angle), std::sin(angle), 0);
  };
  for (const double z : {-height / 2, height / 2})
    for (int k = 0; k < parts; ++k) node.push_back(radius * around(k) + z * Vector3d::UnitZ());
  node.emplace_back(0, 0, -height / 2);
  node.emplace_back(0, 0, height / 2);
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::array<Vector3d, 3>> normals;
  for (int k = 0; k < parts; ++k) {
    const int next = (k + 1) % parts;
    const Vector3d n = around(k), m = around(next), up = Vector3d::UnitZ();
    triangles.insert(triangles.end(), {{k, next, parts + next},
                                       {k, parts + next, parts + k},
                                       {2 * parts, next, k},
                                       {2 * parts + 1, parts + k, parts + next}});
    normals.insert(normals.end(), {{n, m, m}, {n, m, n}, {-up, -up, -up}, {up, up, up}});
  }
  const double across = mass * (radius * radius / 4 + height * height / 12);
  kernels::Kernel kernel = rigid_body(mass, {across, across, mass * radius * radius / 2}, node, flexibility);
  cover(kernel, triangles, normals, flexibility, radius / 5, 0);
  return kernel;
}

/// A square plate whose faces are divided into n × n squares, with its upper face at z = 0.
kernels::Kernel plate(double mass, double side, double height, int n, double flexibility) {
  std::vector<Vector3d> node;
  std::map<std::array<int, 3>, int> number;
  const auto at = [&](const std::array<int, 3>& place) {
    const auto [known, is_new] = number.try_emplace(place, static_cast<int>(node.size()));
    if (is_new)
      node.emplace_back(side * (1.0 * place[0] / n - 0.5), side * (1.0 * place[1] / n - 0.5),
                        height * (place[2] - 1));
    return known->second;
  };
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::array<Vector3d, 3>> normals;
  for (int axis = 0; axis < 3; ++axis)
    for (const int end : {0, axis == 2 ? 1 : n})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < (axis == 2 ? n : 1); ++j) {
          const auto corner = [&](int u, int v) {
            std::array<int, 3> place{i + u, j + v, end};
            if (axis < 2) place = axis == 0 ? std::array{end, i + u, v} : std::array{i + u, end, v};
            return at(place);
          };
          std::array<int, 4> quad{corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
          if ((end == 0) != (axis == 1)) std::swap(quad[1], quad[3]);  // outwards
          triangles.insert(triangles.end(), {{quad[0], quad[1], quad[2]}, {quad[0], quad[2], quad[3]}});
          const Vector3d outward = (end == 0 ? -1 : 1) * Vector3d::Unit(axis);
          normals.insert(normals.end(), 2, {outward, outward, outward});
        }
  const Vector3d centre(0, 0, -height / 2);
  for (Vector3d& x : node) x -= centre;
  const double across = mass * (side * side + height * height) / 12;
  kernels::Kernel kernel = rigid_body(mass, {across, across, mass * side * side / 6}, node, flexibility);
  cover(kernel, triangles, normals, flexibility, side / n, 0);
  return kernel;
}

/// A top on its tip at (0, 0, −l): a cone with a lid.
kernels::Kernel top(double mass, double across, double about_axis, double l, double flexibility) {
  constexpr int parts = 12;
  const double half_angle = std::numbers::pi / 6, height = 1.5 * l;
  const Vector3d up = Vector3d::UnitZ();
  const auto around = [](double k) {
    const double angle = 2 * std::numbers::pi * k / parts;
    return Vector3d(std::cos(angle), std::sin(angle), 0);
  };
  const auto outward = [&](double k) -> Vector3d {
    return std::cos(half_angle) * around(k) - std::sin(half_angle) * up;
  };
  std::vector<Vector3d> node{-l * up, (height - l) * up};
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::array<Vector3d, 3>> normals;
  for (int k = 0; k < parts; ++k) {
    const int next = (k + 1) % parts;
    node.push_back(node[1] + height * std::tan(half_angle) * around(k));
    triangles.insert(triangles.end(), {{0, 2 + next, 2 + k}, {1, 2 + k, 2 + next}});
    normals.insert(normals.end(), {{outward(k + 0.5), outward(k + 1), outward(k)}, {up, up, up}});
  }
  kernels::Kernel kernel = rigid_body(mass, {across, across, about_axis}, node, flexibility);
  cover(kernel, triangles, normals, flexibility, 0.3 * l, 0);
  return kernel;
}

/// The highest point of a ball in any direction is at its radius, and at most 1e-4 of it beside the
/// direction: quadratic triangles through points and normals of a sphere err by about (h/r)⁴/40 with h = 0.33
/// r.
TEST(BodySurface, of_a_ball_is_as_high_in_every_direction) {
  const kernels::Kernel kernel = ball(1, 1, 1e-9);
  const BodySurface surface(kernel);
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::vector<Foot> found;
  found.reserve(4);
  for (int k = 0; k < 1000; ++k) {
    const Vector3d n = ricochet::test::drawn(normal, random).normalized();
    surface.summits(n, 0.5, found);
    ASSERT_GE(found.size(), 1U);
    EXPECT_NEAR(n.dot(found[0].point), 1, 6e-5);
    EXPECT_LT((found[0].point - n).norm(), 2e-3);
    const Foot climbed = surface.summit(0, {.up = n});
    EXPECT_NEAR(n.dot(climbed.point), n.dot(found[0].point), 1e-5);
  }
}

/// Around the rim of a disk, no point is taken for one inside, although the arcs of the rim pass over its
/// chords, by 5e-3 of the radius. A point that is followed has the foot that a search finds.
TEST(BodySurface, of_a_disk_is_left_beyond_its_rim) {
  const kernels::Kernel kernel = disk(1, 1, 0.2, 1e-9);
  const BodySurface surface(kernel);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> share(0, 1);
  Foot foot = surface.closest({1, 0, 0.1});
  for (int k = 0; k < 20'000; ++k) {
    const bool above = k % 2;
    const double beyond = above ? 0.024 * share(random) - 0.004 : 0.02 + 0.5 * share(random),
                 rise = above ? 0.03 + 0.08 * share(random) : 0.02 * share(random) - 0.01, angle = 1e-3 * k;
    const Vector3d x =
        (1 + beyond) * Vector3d(std::cos(angle), std::sin(angle), 0) + (0.1 + rise) * Vector3d::UnitZ();
    foot = surface.follow(foot, x);
    ASSERT_NEAR(foot.distance, std::hypot(std::max(0.0, beyond), std::max(0.0, rise)), 6e-3) << k;
    ASSERT_NEAR(foot.distance, surface.closest(x).distance, 1e-9) << k;
  }
}

/// Friction takes 2/7 of the energy of a ball that slides, and then it rolls with 5/7 of its speed. The
/// height of its centre then follows from the surface alone, and it stays on the floor, on one point.
TEST(Rolling, of_a_ball_that_slides_at_first_ends_at_five_sevenths) {
  const double mass = 0.03, radius = 0.01, speed = 0.2, mu = 0.3;
  const kernels::Kernel kernel = ball(mass, radius, 1e-8);
  PlacedBody body;
  body.velocity = {speed, 0, 0};
  auto stepper = make_stepper(over_floor(kernel, body, {mu, mu, 0}, {0, 0, -g}), stepping(44'100));
  const double start = stepper->modal()->energy().kinetic;
  double lowest = 1, highest = -1;
  while (stepper->time() < 0.2) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    if (stepper->time() < 0.06) continue;  // it slides for 2v/7μg = 19 ms
    EXPECT_EQ(stepper->active(), 1);
    const Pose pose = stepper->poses()[0];
    lowest = std::min(lowest, pose.position.z());
    highest = std::max(highest, pose.position.z());
  }
  const Pose end = stepper->poses()[0];
  EXPECT_NEAR(end.velocity.x(), 5 * speed / 7, 1e-3 * speed);
  EXPECT_NEAR(end.spin.y() * radius, 5 * speed / 7, 2e-3 * speed);
  EXPECT_NEAR(stepper->modal()->energy().friction / start, 2.0 / 7, 1e-3);
  // Ripple of the surface, 2e-5 of the radius, and the rest of the bounce on a contact that yields by 0.3 µm
  EXPECT_LT(highest - lowest, 1e-4 * radius);
  EXPECT_LT(std::abs(stepper->modal()->energy().contact), 1e-3 * start);
}

/// All candidates yield by f, so the ball does, too, wherever it rolls: between candidates, R alone would be
/// smaller by almost half. With bulges b it follows Hertz's law δ = 3 b^(1/3) (f λ/2)^(2/3). Patches of other
/// sizes bulge in proportion to their areas, which must not show.
TEST(Rolling, of_a_ball_yields_alike_between_candidates) {
  const double mass = 0.03, radius = 0.01, f = 1e-4;
  for (const double bulge : {0.0, 1.5e-4}) {
    kernels::Kernel kernel = ball(mass, radius, f, bulge);
    for (std::size_t i = 0; i < kernel.surface.size(); ++i) {
      const double larger = 1 + 0.5 * static_cast<double>(i % 3);
      kernel.surface.area[i] *= larger;
      kernel.surface.bulge[i] *= larger;
    }
    PlacedBody body;
    body.velocity = {0.2, 0, 0};
    auto stepper = make_stepper(over_floor(kernel, body, {0.3, 0.3, 0}, {0, 0, -g}), stepping(44'100));
    int compared = 0;
    while (stepper->time() < 0.1) {
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      const double force = stepper->end_force().head(stepper->points()).sum();
      if (force < 0.2 * mass * g) continue;
      const double law = bulge > 0 ? 3 * std::cbrt(bulge) * std::pow(f * force / 2, 2.0 / 3) : f * force;
      // The surface ripples by 2e-5 of the radius.
      ASSERT_NEAR((radius - stepper->poses()[0].position.z()) / law, 1, 0.05);
      ++compared;
    }
    EXPECT_GT(compared, 2000);
  }
}

/// Two bodies that may touch with all of their surfaces.
std::shared_ptr<const Model> together(const kernels::Kernel& first, PlacedBody a,
                                      const kernels::Kernel& second, PlacedBody b,
                                      const std::optional<Friction>& friction) {
  a.name = "a";
  a.kernel = &first;
  b.name = "b";
  b.kernel = &second;
  PairRequest pair{"a", "b", {}, {}, {}};
  pair.friction = friction;
  pair.everywhere = true;
  return std::make_shared<const Model>(build_model({a, b}, {}, {pair}, Vector3d::Zero()));
}

/// A disk whose centre rests while its rim rolls precesses steadily at Ω, Ω² sin α (I cos α − K sin α h/2a) =
/// m g (a cos α − ½h sin α), with the moments I across and K about its axis. On a plate that is a body, it
/// moves as on a half-space, whichever of them is body a and has the finer mesh.
TEST(Rolling, of_a_disk_in_steady_precession_is_steady) {
  const double mass = 0.007, a = 0.012, h = 0.002, tilt = std::numbers::pi / 9;
  const double I = mass * (a * a / 4 + h * h / 12), K = mass * a * a / 2, c = std::cos(tilt),
               s = std::sin(tilt);
  const double rate = std::sqrt(mass * g * (a * c - h / 2 * s) / (s * (I * c - K * s * h / (2 * a))));
  const kernels::Kernel kernel = disk(mass, a, h, 1e-8), coarse = plate(1e6 * mass, 0.04, 0.01, 3, 1e-9),
                        fine = plate(1e6 * mass, 0.04, 0.01, 9, 1e-9);
  PlacedBody body, ground;
  body.rotation = turn(tilt, Vector3d::UnitX());
  // About the line from the point of contact to the centre
  const Vector3d up = body.rotation * Vector3d::UnitY(), axis = body.rotation * Vector3d::UnitZ();
  body.angular_velocity = rate * s * (up + h / (2 * a) * axis);
  const std::optional<Friction> rough = Friction{1, 1, 0};
  struct Case {
    std::shared_ptr<const Model> model;
    std::size_t disk;
  };
  std::vector<Case> cases{{over_floor(kernel, body, *rough, {0, 0, -g}), 0}};
  body.translation = {0, 0, a * s + h / 2 * c};
  ground.translation = {0.0013, 0.0007, -0.005};
  for (const kernels::Kernel* under : {&coarse, &fine}) {
    cases.push_back({together(kernel, body, *under, ground, rough), 0});
    cases.push_back({together(*under, ground, kernel, body, rough), 1});
  }
  for (const auto& [model, k] : cases) {
    const std::string what = std::to_string(&model - &cases.front().model);
    auto stepper = make_stepper(model, stepping(44'100));
    const bool pushed = model->gravity.isZero(0);
    const double period = 2 * std::numbers::pi / rate, start = stepper->modal()->energy().kinetic;
    double angle = 0, before = std::atan2(axis.y(), axis.x()), fastest = 0;
    while (stepper->time() < period) {
      if (pushed) stepper->push(static_cast<int>(k), {0, 0, -mass * g}, Vector3d::Zero());
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      const Pose pose = stepper->poses()[k];
      const Vector3d now = pose.attitude * Vector3d::UnitZ();
      const double direction = std::atan2(now.y(), now.x());
      angle += std::remainder(direction - before, 2 * std::numbers::pi);
      before = direction;
      fastest = std::max(fastest, std::abs(pose.velocity.z()));
      ASSERT_NEAR(std::acos(now.z()), tilt, 1e-4 * tilt) << what;
      ASSERT_EQ(stepper->active(), 1) << what;
    }
    // The parabolas of the rim differ from its circle by up to a (2π/32)⁴/128 = 1.2e-5 a.
    EXPECT_NEAR(angle / (rate * stepper->time()), 1, 1e-5) << what;
    EXPECT_LT(stepper->modal()->energy().friction + stepper->modal()->energy().contact, 2e-5 * start) << what;
    EXPECT_LT(fastest, 1e-4 * rate * a) << what;
  }
}

/// By symmetry, two equal balls meet as each would meet a rigid wall between them. The second one is the
/// mirror image of the first, since an icosahedron is its own image in its centre.
TEST(Rolling, of_two_balls_is_that_on_the_wall_between_them) {
  const double mass = 0.03, radius = 0.01;
  const kernels::Kernel kernel = ball(mass, radius, 1e-7, 1.5e-4);
  for (const double angle : {0.0, 0.3, 0.9}) {
    PlacedBody falling, rising;
    falling.rotation = turn(angle, Vector3d(1, 2, 0).normalized());
    falling.velocity = {0, 0, -1};
    rising.rotation = turn(std::numbers::pi, Vector3d::UnitZ()) * falling.rotation;
    rising.velocity = {0, 0, 1};
    auto wall = make_stepper(over_floor(kernel, falling, {0, 0, 0}, {0, 0, 0}), stepping(441'000));
    const Vector3d down = falling.rotation.transpose() * -Vector3d::UnitZ();
    falling.translation = {0, 0, 2 * down.dot(BodySurface(kernel).summit(0, {.up = down}).point)};
    auto pair = make_stepper(together(kernel, falling, kernel, rising, {}), stepping(441'000));
    double peak = 0, most = 0;
    int touching = 0;
    for (int k = 0; k < 1000; ++k) {
      ASSERT_EQ(wall->step(), StepStatus::ok);
      ASSERT_EQ(pair->step(), StepStatus::ok);
      const double on_wall = wall->force().sum(), between = pair->force().sum();
      peak = std::max(peak, on_wall);
      most = std::max(most, std::abs(on_wall - between));
      touching += between > 0;
    }
    EXPECT_GT(touching, 20);
    // The place of the summit on the wall is exact; between balls, it is where interpolated normals agree.
    EXPECT_LT(most, 5e-3 * peak) << angle;
    EXPECT_NEAR(pair->poses()[0].velocity.z(), wall->poses()[0].velocity.z(), 1e-4);
    EXPECT_LT(pair->poses()[0].spin.norm() * radius, 5e-3);
  }
}

/// Friction takes 2/7 of the energy of a ball that slides over a body which is heavy and large. The normals
/// of the surfaces, interpolated from the nodes, differ from their true ones by 5e-4, over which the ball may
/// hop.
TEST(Rolling, of_a_ball_on_a_body_ends_at_five_sevenths) {
  const double mass = 0.03, radius = 0.01, large = 3, speed = 0.2, mu = 0.3;
  const kernels::Kernel kernel = ball(mass, radius, 1e-8), under = ball(1e6 * mass, large, 1e-9);
  PlacedBody body, ground;
  body.velocity = {speed, 0, 0};
  body.translation = {0, 0, large + radius};
  auto stepper = make_stepper(together(kernel, body, under, ground, Friction{mu, mu, 0}), stepping(20'000));
  const double start = stepper->modal()->energy().kinetic;
  int on_one = 0, otherwise = 0;
  while (stepper->time() < 0.1) {
    const Pose now = stepper->poses()[0];
    stepper->push(0, -mass * g * now.position.normalized(), Vector3d::Zero());
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    if (stepper->time() > 0.04) (stepper->active() == 1 ? on_one : otherwise) += 1;
  }
  EXPECT_LT(otherwise, 0.01 * on_one);
  const Pose end = stepper->poses()[0];
  EXPECT_NEAR(end.velocity.norm(), 5 * speed / 7, 1e-3 * speed);
  EXPECT_NEAR(end.spin.norm() * radius, 5 * speed / 7, 2e-3 * speed);
  EXPECT_NEAR(stepper->modal()->energy().friction / start, 2.0 / 7, 1e-3);
}

/// A ball that falls on the edge of a plate is pushed along the line from the nearest point of the edge,
/// wherever the nodes of both are.
TEST(Rolling, of_a_ball_over_an_edge_is_pushed_from_its_nearest_point) {
  const double mass = 0.03, radius = 0.01;
  const kernels::Kernel kernel = ball(mass, radius, 1e-8), under = plate(1e6 * mass, 0.08, 0.02, 4, 1e-9);
  for (const double place : {0.001, 0.0064, 0.0093})  // along the edge, whose nodes are 20 mm apart
    for (const double aside : {0.3, 0.8})             // of 45 degrees beyond the edge
      for (const bool is_a : {true, false}) {
        const double angle = aside * std::numbers::pi / 4;
        const Vector3d out(std::sin(angle), 0, std::cos(angle));
        PlacedBody body, ground;
        body.rotation = turn(0.7, Vector3d(1, 2, 3).normalized());
        body.translation = Vector3d(0.04, place, 0.01) + (radius + 2e-5) * out;
        body.velocity = -0.1 * out;
        auto stepper = make_stepper(
            is_a ? together(kernel, body, under, ground, {}) : together(under, ground, kernel, body, {}),
            stepping(200'000));
        const std::size_t k = is_a ? 0 : 1;
        while (stepper->time() < 1e-3) ASSERT_EQ(stepper->step(), StepStatus::ok);
        const Vector3d change = stepper->poses()[k].velocity - body.velocity;
        ASSERT_GT(change.norm(), 0.15) << place << " " << aside << " " << is_a;
        // Normals of the surface of the ball differ from those of a sphere by 7e-4, and so do places over the
        // radius: Δω r = 5/2 of it Δv.
        EXPECT_LT((change.normalized() - out).norm(), 2e-3) << place << " " << aside << " " << is_a;
        EXPECT_LT(stepper->poses()[k].spin.norm() * radius, 4e-3 * change.norm());
      }
}

/// A ball that rolls to and fro in a cavity swings with (7/5 (R − r)/g)^½ 2π (1 + θ²/16), about its lowest
/// place, and does not stop.
TEST(Rolling, of_a_ball_in_a_cavity_is_that_of_a_pendulum) {
  const double mass = 0.03, radius = 0.01, around = 0.04, angle = 0.2;
  const kernels::Kernel kernel = ball(mass, radius, 1e-8), shell = cavity(1e6 * mass, around, 1e-9);
  PlacedBody body, outside;
  body.translation = (around - radius - 1e-6) * Vector3d(std::sin(angle), 0, -std::cos(angle));
  outside.rotation = turn(0.4, Vector3d(1, 2, 3).normalized());
  auto stepper = make_stepper(together(kernel, body, shell, outside, Friction{1, 1, 0}), stepping(20'000));
  const double period =
      2 * std::numbers::pi * std::sqrt(1.4 * (around - radius) / g) * (1 + angle * angle / 16);
  std::vector<double> crossings;
  double before = 1, farthest = 0, lowest = 1, highest = 0;
  while (stepper->time() < 1.3 * period) {
    stepper->push(0, -mass * g * Vector3d::UnitZ(), Vector3d::Zero());
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    const Vector3d now = stepper->poses()[0].position;
    if (now.x() * before < 0) crossings.push_back(stepper->time());
    before = now.x();
    lowest = std::min(lowest, now.norm());
    highest = std::max(highest, now.norm());
    if (stepper->time() > 0.8 * period)
      farthest = std::max(farthest, std::abs(std::atan2(now.x(), -now.z())));
  }
  ASSERT_EQ(crossings.size(), 3U);
  EXPECT_NEAR(crossings[2] - crossings[0], period, 2e-3 * period);
  EXPECT_NEAR(farthest, angle, 5e-3 * angle);
  // The surfaces ripple by 6e-5 of their radii, and the ball falls by 1 µm at first. If its summit were that
  // of the start of each step, it would sink and be thrown back by 9 µm.
  EXPECT_LT(highest - lowest, 6e-5 * (around + radius) + 1e-6);
}

/// A heavy top about a fixed point, from a moment at which its tilt is at rest.
struct Nutation {
  double period;       ///< [s]
  double precession;   ///< in a period [rad]
  double first, last;  ///< cosines of the tilts between which it swings

  /// With u = cos θ, u̇² = (1 − u²)(α − βu) − (p − qu)² = β(u − u₀)(u − u₁)(u − u₂) and φ̇ = (p − qu)/(1 − u²).
  /// With u = ½(u₀ + u₁) + ½(u₀ − u₁) cos s, integrals over s are smooth.
  /// @param across  the moment about the point  @param pull  m g l  @param rate  φ̇ at the start
  Nutation(double across, double about_axis, double pull, double spin, double rate, double tilt)
      : period(0), precession(0), first(std::cos(tilt)) {
    const double square = 1 - first * first, q = about_axis * spin / across, p = rate * square + q * first,
                 beta = 2 * pull / across, alpha = rate * rate * square + beta * first;
    const double b = beta * first - alpha - q * q, c = b * first + 2 * p * q - beta,
                 root = std::sqrt(b * b - 4 * beta * c), beyond = (root - b) / (2 * beta);
    last = -(root + b) / (2 * beta);
    constexpr int parts = 32;
    for (int k = 0; k < parts; ++k) {
      const double u = (first + last + (first - last) * std::cos(std::numbers::pi * (k + 0.5) / parts)) / 2;
      const double time = 2 * std::numbers::pi / parts / std::sqrt(beta * (beyond - u));
      period += time;
      precession += time * (p - q * u) / (1 - u * u);
    }
  }
};

/// Friction holds the tip, so the top moves as about a fixed point: in steady precession at the rate Ω with
/// I₃ω₃Ω − I₁Ω² cos θ = m g l, or in cusps, if its axis is released at rest. The tip bears nothing at first,
/// so it falls by 1 µm in a step until it is held, in proportion to Δ², which is also the error.
TEST(Rolling, of_a_heavy_top_on_a_rough_tip_precesses_as_about_a_fixed_point) {
  const double mass = 0.1, l = 0.03, across = 2e-5, about_axis = 3e-5, tilt = std::numbers::pi / 6,
               steady = 10;
  const double about_tip = across + mass * l * l;
  const double spin = (mass * g * l + about_tip * steady * steady * std::cos(tilt)) / (about_axis * steady);
  const kernels::Kernel kernel = top(mass, across, about_axis, l, 1e-7);
  for (const double rate : {steady, 0.0}) {
    const Nutation exact(about_tip, about_axis, mass * g * l, spin, rate, tilt);
    PlacedBody body;
    body.rotation = turn(tilt, Vector3d::UnitX());
    Vector3d axis = body.rotation * Vector3d::UnitZ();
    body.angular_velocity = rate * Vector3d::UnitZ() + (spin - rate * std::cos(tilt)) * axis;
    body.velocity = body.angular_velocity.cross(l * axis);
    constexpr int periods = 6, parts = 3000;
    auto stepper =
        make_stepper(over_floor(kernel, body, {1, 1, 0}, {0, 0, -g}), stepping(parts / exact.period));
    const Vector3d tip = stepper->poses()[0].position - l * axis;
    const double start = stepper->modal()->energy().kinetic;
    double angle = 0, least = 1, most = 0;
    for (int k = 0; k < periods * parts; ++k) {
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      const Pose pose = stepper->poses()[0];
      const Vector3d now = pose.attitude * Vector3d::UnitZ();
      angle +=
          std::remainder(std::atan2(now.y(), now.x()) - std::atan2(axis.y(), axis.x()), 2 * std::numbers::pi);
      axis = now;
      least = std::min(least, now.z());
      most = std::max(most, now.z());
      ASSERT_LT((pose.position - l * now - tip).norm(), 1e-4 * l);
    }
    EXPECT_NEAR(angle / (periods * exact.precession), 1, 1e-4);
    EXPECT_NEAR(least, std::min(exact.first, exact.last), 1e-4);
    EXPECT_NEAR(most, std::max(exact.first, exact.last), 1e-4);
    EXPECT_LT(stepper->modal()->energy().friction, 1e-6 * start);
  }
}

/// An ellipsoid that rolls on a floor without slip, by the method of Runge and Kutta.
class RollingEllipsoid {
 public:
  /// @param up  in the axes of the body  @param rate  of the spin about the vertical
  RollingEllipsoid(const Ellipsoid& body, const Vector3d& up, double rate)
      : body_(body),
        tensor_(body.own_axes() * body.axes.cwiseAbs2().asDiagonal() * body.own_axes().transpose()),
        now_{up, rate * up} {}

  double rate() const { return now_.up.dot(now_.spin); }
  Vector3d velocity() const { return -now_.spin.cross(arm(now_.up)); }  ///< in the axes of the body

  void step(double h) {
    State sum{Vector3d::Zero(), Vector3d::Zero()}, slope = sum;
    for (const auto& [way, weight] : {std::pair{0.0, 1.0}, {0.5, 2.0}, {0.5, 2.0}, {1.0, 1.0}}) {
      slope = rates({now_.up + way * h * slope.up, now_.spin + way * h * slope.spin});
      sum = {sum.up + weight / 6 * slope.up, sum.spin + weight / 6 * slope.spin};
    }
    now_ = {now_.up + h * sum.up, now_.spin + h * sum.spin};
  }

 private:
  struct State {
    Vector3d up, spin;  ///< in the axes of the body
  };

  /// From the centre of mass to the contact.
  Vector3d arm(const Vector3d& up) const {
    return body_.height * Vector3d::UnitZ() - tensor_ * up / std::sqrt(up.dot(tensor_ * up));
  }

  /// With the arm r and the velocity v = −ω × r: u̇ = u × ω, J ω̇ + ω × Jω = r × m(v̇ + ω × v + g u).
  State rates(const State& at) const {
    const auto& [u, w] = at;
    const Vector3d du = u.cross(w), towards = tensor_ * u, r = arm(u);
    const double n = std::sqrt(u.dot(towards));
    const Vector3d dr = towards * towards.dot(du) / (n * n * n) - tensor_ * du / n;
    const Matrix3d inertia = body_.moments.asDiagonal();
    const Matrix3d about_contact =
        inertia + body_.mass * (r.squaredNorm() * Matrix3d::Identity() - r * r.transpose());
    const Vector3d push = body_.mass * (g * u - w.cross(dr) - w.cross(w.cross(r)));
    return {du, about_contact.ldlt().solve(r.cross(push) - w.cross(inertia * w))};
  }

  Ellipsoid body_;
  Matrix3d tensor_;
  State now_;
};

/// A rattleback, whose axes of inertia and of curvature are 10° apart, rocks and reverses if it is
/// spun in one sense and spins on in the other.
TEST(Rolling, of_a_rattleback_reverses_for_one_sense_of_spin_only) {
  const double a = 0.1, b = 0.025, c = 0.02, degree = std::numbers::pi / 180, step = 2e-4;
  Ellipsoid body{.mass = 0.2,
                 .moments = {b * b + c * c, a * a + c * c, a * a + b * b},
                 .axes = {a, b, c},
                 .height = 3 * c / 8,
                 .turned = 10 * degree};
  // Those of half an ellipsoid
  body.moments *= body.mass / 5;
  body.moments.head<2>().array() -= body.mass * body.height * body.height;
  const kernels::Kernel kernel = body.kernel(1e-6);
  for (const double rate : {2.0, -2.0}) {
    PlacedBody placed;
    placed.rotation = turn(0.5 * degree, Vector3d::UnitY());
    RollingEllipsoid exact(body, placed.rotation.transpose() * Vector3d::UnitZ(), rate);
    placed.angular_velocity = rate * Vector3d::UnitZ();
    placed.velocity = placed.rotation * exact.velocity();
    auto stepper = make_stepper(over_floor(kernel, placed, {1, 1, 0}, {0, 0, -g}), stepping(1 / step));
    const double start = stepper->modal()->energy().kinetic;
    double heading = 0, expected = 0, worst = 0;
    while (stepper->time() < 1.5) {
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      heading += step * stepper->poses()[0].spin.z();
      expected += step * exact.rate();
      exact.step(step);
      worst = std::max(worst, std::abs(heading - expected));
    }
    const double spin = stepper->poses()[0].spin.z();
    EXPECT_EQ(spin * rate<0, rate> 0);
    EXPECT_NEAR(spin, exact.rate(), 0.01 * std::abs(rate));
    // It turns by 1 rad until it reverses. The error falls with the third power of the size of the elements.
    EXPECT_LT(worst, 0.015);
    EXPECT_LT(stepper->modal()->energy().friction + stepper->modal()->energy().contact, 0.01 * start);
  }
}

/// Where the surface is pressed by more than it falls away, the candidates around touch, too.
TEST(Rolling, of_a_soft_ball_rests_on_many_points) {
  const double mass = 0.03, radius = 0.01;
  const kernels::Kernel kernel = ball(mass, radius, 3e-3);
  PlacedBody body;
  body.velocity = {0.1, 0, -0.1};
  auto stepper = make_stepper(over_floor(kernel, body, {0.5, 0.5, 0}, {0, 0, -g}), stepping(20'000));
  const double start = stepper->modal()->energy().total();
  int most = 0;
  for (int k = 0; k < 4000; ++k) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    most = std::max(most, stepper->active());
    ASSERT_LE(stepper->modal()->energy().total(), start + 1e-12 * std::abs(start));
  }
  EXPECT_GE(most, 4);
}

/// A mode lowers a candidate beside the lowest point of a long egg below it. The candidate touches first, at
/// its own height. If it stood back by the negative fall, it would touch 70 µs later, 7 µm too deep.
TEST(Rolling, on_a_candidate_that_a_mode_makes_the_lowest) {
  const double radius = 0.01, speed = 0.1, lowered = 1e-3, gap = 5e-5, step = 5e-6;
  const Vector3d axes(1.5, 1, 1);
  kernels::Kernel kernel = deformed_sphere(
      0.03, Vector3d::Constant(1e-6),
      [&](const Vector3d& x) -> Vector3d { return radius * axes.cwiseProduct(x); },
      [&](const Vector3d& x) -> Vector3d { return x.cwiseQuotient(axes).normalized(); }, 1e-6, 0.3 * radius,
      0);
  // Its neighbours are 3.2 mm away on average.
  const auto at = [&](std::size_t k) { return Eigen::Map<const Vector3d>(&kernel.surface.node[3 * k]); };
  const auto unfit = [&](std::size_t k) { return (at(k) - radius * Vector3d(0.45, 0, -0.95)).norm(); };
  std::size_t beside = 0;
  for (std::size_t k = 0; k < kernel.surface.size(); ++k)
    if (unfit(k) < unfit(beside)) beside = k;
  add_mode(kernel, 1e-3, [&](std::size_t k) -> Vector3d { return -(k == beside) * Vector3d::UnitZ(); });
  PlacedBody body;
  body.velocity.z() = -speed;
  Model model = *over_floor(kernel, body, {}, Vector3d::Zero(), lowered + gap);
  model.q0(6) = radius + at(beside).z() + lowered;
  const auto stepper = make_stepper(std::make_shared<const Model>(model), stepping(1 / step));
  while (stepper->time() < 0.01 && stepper->active() == 0) ASSERT_EQ(stepper->step(), StepStatus::ok);
  EXPECT_NEAR(stepper->time(), gap / speed, 2 * step);
  EXPECT_GT(stepper->end_force()(static_cast<Eigen::Index>(beside)), 0);
}

/// Long elements far from the touch do not change it: a ball whose other side is drawn out like a bullet
/// meets the floor with the force of the ball, to round-off.
TEST(Rolling, of_a_bullet_on_its_tip_is_that_of_a_ball) {
  const double mass = 0.03, radius = 0.01, flexibility = 3e-3;
  const auto outward = [](const Vector3d& x) { return x; };
  const auto drawn_out = [&](double times) {
    return deformed_sphere(
        mass, Vector3d::Constant(0.4 * mass * radius * radius),
        [&](const Vector3d& x) -> Vector3d {
          return radius * Vector3d(x.x(), x.y(), x.z() < 0 ? x.z() : times * x.z());
        },
        outward, flexibility, 0.3 * radius, 0);
  };
  const kernels::Kernel round = drawn_out(1), bullet = drawn_out(10);
  PlacedBody body;
  body.velocity = {0, 0, -0.1};
  const auto start = [&](const kernels::Kernel& kernel) {
    return make_stepper(over_floor(kernel, body, {0.5, 0.5, 0}, {0, 0, -g}), stepping(20'000));
  };
  const auto of_ball = start(round), of_bullet = start(bullet);
  double peak = 0, apart = 0;
  int most = 0;
  for (int k = 0; k < 2000; ++k) {
    ASSERT_EQ(of_ball->step(), StepStatus::ok);
    ASSERT_EQ(of_bullet->step(), StepStatus::ok);
    const double force = of_ball->force().head(of_ball->points()).sum();
    most = std::max(most, of_ball->active());
    peak = std::max(peak, force);
    apart = std::max(apart, std::abs(of_bullet->force().head(of_bullet->points()).sum() - force));
  }
  EXPECT_GE(most, 4);
  EXPECT_LT(apart, 1e-9 * peak);
}

/// A ball with spin falls and bounces, on R in double precision, in single precision, and compressed. What
/// differs is the residual displacement, by the stated error.
TEST(Rolling, on_a_compact_flexibility_is_that_on_the_whole_one) {
  const double mass = 0.03, radius = 0.01;
  kernels::Kernel whole = ball(mass, radius, 3e-3);
  const std::size_t candidates = whole.surface.size();
  whole.surface.area.assign(candidates,
                            4 * std::numbers::pi * radius * radius / static_cast<double>(candidates));
  kernels::Kernel single = whole, compressed = whole;
  kernels::make_compact(single.surface);
  kernels::make_compact(compressed.surface, {.most_whole = 0, .radius = 1.5});
  ASSERT_FALSE(single.surface.compact->compressed());
  const double stated = compressed.surface.compact->error;
  EXPECT_GT(stated, 1e-4);
  EXPECT_LT(stated, 0.05);
  struct Touch {
    double peak = 0;
    Vector3d velocity{0, 0, 0}, spin{0, 0, 0};
    int most = 0;
  };
  const auto bounce = [&](const kernels::Kernel& kernel) {
    PlacedBody body;
    body.velocity = {0.3, 0, -0.5};
    body.angular_velocity = {0, 10, 0};
    auto stepper = make_stepper(over_floor(kernel, body, {0.5, 0.5, 0}, {0, 0, -g}), stepping(40'000));
    const double start = stepper->modal()->energy().total();
    Touch out;
    while (stepper->time() < 0.06) {
      EXPECT_EQ(stepper->step(), StepStatus::ok);
      out.peak = std::max(out.peak, stepper->end_force().head(stepper->points()).sum());
      out.most = std::max(out.most, stepper->active());
      EXPECT_LE(stepper->modal()->energy().total(), start + 1e-12 * std::abs(start));
    }
    out.velocity = stepper->poses()[0].velocity;
    out.spin = stepper->poses()[0].spin;
    return out;
  };
  const auto differ = [](const Touch& a, const Touch& b) {
    return std::max({std::abs(a.peak / b.peak - 1), (a.velocity - b.velocity).norm() / b.velocity.norm(),
                     (a.spin - b.spin).norm() / b.spin.norm()});
  };
  const Touch exact = bounce(whole), in_single = bounce(single), in_parts = bounce(compressed);
  EXPECT_GE(exact.most, 4);
  EXPECT_GT(exact.velocity.z(), 0.1);         // it has bounced
  EXPECT_LT(differ(in_single, exact), 1e-4);  // the diagonal is raised by 1e-5
  EXPECT_LT(differ(in_parts, exact), stated);
  EXPECT_GT(differ(in_parts, exact), 0);
}

}  // namespace rolling_test
}  // namespace ricochet::contact::test
