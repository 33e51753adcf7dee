// SPDX-License-Identifier: BSD-2-Clause
// How far from the closest pair candidates may touch, and how many candidates lie there.
#include "src/accuracy/contact_zone.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "src/scene/scene.hpp"

namespace contact_zone_test {

using namespace ricochet;
using accuracy::expected_candidates;
using accuracy::within_flight;
using accuracy::zone_of;

scene::Scene two_bodies_in_flight() {
  scene::Scene scene;
  scene.bodies.resize(2);
  scene.bodies[0].velocity = {0, 3, 4};
  scene.bodies[1].velocity = {-1, 0, 0};
  scene.time.duration = 0.1;
  return scene;
}

// Two bodies with 5 and 1 m/s approach by 0.6 m in 0.1 s at most, and by 0.7 m under 10 m/s² on both.
TEST(Flight, is_bounded_by_speeds_and_gravity) {
  scene::Scene scene = two_bodies_in_flight();
  EXPECT_DOUBLE_EQ(within_flight(scene).value_or(0), 2 * 0.6);
  scene.loads.gravity = {0, 0, -10};
  EXPECT_DOUBLE_EQ(within_flight(scene).value_or(0), 2 * 0.7);
}

TEST(Flight, has_no_bound_at_rest_or_if_bodies_are_turned_or_driven) {
  for (const std::function<void(scene::Scene&)>& change :
       {std::function([](scene::Scene& scene) { scene.contact.scheme = Scheme::at_rest; }),
        std::function([](scene::Scene& scene) {
          scene.bodies[1].angular_velocity = {0, 0, 1e-3};
        }),
        std::function([](scene::Scene& scene) { scene.loads.tractions.emplace_back(); }),
        std::function([](scene::Scene& scene) { scene.loads.points.emplace_back(); }),
        std::function([](scene::Scene& scene) { scene.loads.motions.emplace_back(); }),
        std::function([](scene::Scene& scene) {
          for (scene::Body& body : scene.bodies) body.velocity = {};
        })}) {
    scene::Scene scene = two_bodies_in_flight();
    change(scene);
    EXPECT_FALSE(within_flight(scene));
  }
}

/// A square grid of 41 × 41 points, and the gap above each of them.
struct Grid {
  kernels::Kernel kernel;
  contact::Model model;
  Grid(double spacing, const std::function<double(double, double)>& gap) {
    constexpr int half = 20, side = 2 * half + 1, points = side * side;
    kernel.surface.area.assign(points, spacing * spacing);
    model.area = contact::Vector::Constant(points, spacing * spacing);
    model.gap.resize(points);
    for (int i = 0; i < points; ++i)
      model.gap[i] = gap((i / side - half) * spacing, (i % side - half) * spacing);
    contact::Bodies::Block& body = model.bodies.emplace_back();
    body.name = "part";
    body.kernel = &kernel;
    model.pairs.push_back({.first_point = 0, .points = points, .a = 0, .b = -1, .reach = {}});
  }
};

constexpr double radius = 0.01;

double above_ball(double x, double y) { return (x * x + y * y) / (2 * radius); }
double above_cylinder(double x, double) { return x * x / (2 * radius); }

accuracy::KernelSettings elements(int order, double size) {
  accuracy::KernelSettings settings;
  settings.mesh["part"].order = order;
  settings.mesh["part"].refine = {{.at = {}, .radius = 1e-3, .size = size}};
  return settings;
}

/// Nodes of equilateral triangles of order p and side s, a triangular lattice of distance s/p, above which
/// the gap is smaller than a distance. The lattice has the extent of a grid.
double nodes(int order, double size, double extent, double distance,
             const std::function<double(double, double)>& gap) {
  const double h = size / order, row = h * std::sqrt(3.0) / 2;
  double count = 0;
  for (int j = -static_cast<int>(extent / row); j <= extent / row; ++j)
    for (int i = -static_cast<int>(extent / h); i <= extent / h; ++i)
      count += gap((i + 0.5 * (j % 2)) * h, j * row) < distance;
  return count;
}

// The grid has 200 points in the circle, which therefore has its area to about 10 %.
TEST(Candidates, expected_near_a_point_are_the_nodes_of_triangles) {
  constexpr double spacing = 5e-5, distance = 8 * 8 * spacing * spacing / (2 * radius);
  const Grid grid(spacing, above_ball);
  for (const int order : {2, 3, 4}) {
    const double expected = nodes(order, 8e-5, 20 * spacing, distance, above_ball);
    EXPECT_NEAR(expected_candidates(grid.model, elements(order, 8e-5), distance) / expected, 1, 0.1);
  }
}

// The grid has only one point within the distance above a ball, and one row above a cylinder: the area grows
// linearly with the gap above a ball, and with its square root above a cylinder. The points of the grid stand
// for squares, so the area of the closest few is known to half a square on each side.
TEST(Candidates, expected_near_few_points_follow_from_those_farther_apart) {
  constexpr double spacing = 1e-3, distance = 0.6 * 0.6 * spacing * spacing / (2 * radius);
  const Grid ball(spacing, above_ball), cylinder(spacing, above_cylinder);
  const double on_ball = nodes(2, 4e-5, 20 * spacing, distance, above_ball);
  const double on_cylinder = nodes(2, 4e-4, 20.5 * spacing, distance, above_cylinder);
  EXPECT_NEAR(expected_candidates(ball.model, elements(2, 4e-5), distance) / on_ball, 1, 0.3);
  EXPECT_NEAR(expected_candidates(cylinder.model, elements(2, 4e-4), distance) / on_cylinder, 1, 0.3);
}

TEST(Candidates, are_those_of_the_model_if_no_element_becomes_smaller) {
  const Grid grid(1e-3, above_ball);
  EXPECT_EQ(expected_candidates(grid.model, {}, above_ball(1.1e-3, 0)), 5);
}

// Of the square of side 40 mm, a circle of radius 8 mm covers an eighth, and one of 20 mm three quarters.
TEST(Zone, is_not_for_contact_that_covers_most_of_a_surface) {
  Grid grid(1e-3, above_ball);
  contact::Quantities run;
  run.pressed.assign(static_cast<std::size_t>(grid.model.gap.size()), false);
  run.nearer = above_ball(8e-3, 0) / 2;
  EXPECT_NEAR(zone_of(grid.model, run).value_or(0), 2 * run.nearer, 1e-5 * run.nearer);
  run.nearer = above_ball(20e-3, 0) / 2;
  EXPECT_FALSE(zone_of(grid.model, run));
  // Coarser patches: a ninth of the points have nine times the area.
  Grid coarse(3e-3, above_ball);
  coarse.kernel.surface.whole.emplace();
  coarse.kernel.surface.whole->area.assign(9 * coarse.model.gap.size(), 1e-6);
  run.nearer = above_ball(24e-3, 0) / 2;
  EXPECT_TRUE(zone_of(coarse.model, run));
  run.nearer = above_ball(60e-3, 0) / 2;
  EXPECT_FALSE(zone_of(coarse.model, run));
}

// A slow ball presses one candidate by far less than the gap of the next ones. On elements of a quarter of
// the size, the zone holds the circle of candidates around it, and not much more.
TEST(Zone, with_finer_elements_keeps_candidates_around_a_single_one_that_was_pressed) {
  constexpr double spacing = 1e-3;
  const Grid grid(spacing, above_ball);
  contact::Quantities run;
  run.pressed.assign(static_cast<std::size_t>(grid.model.gap.size()), false);
  run.pressed[run.pressed.size() / 2] = true;
  run.nearer = 1e-9;
  const double reach = std::sqrt(2 * radius * accuracy::zone_with_finer_elements(grid.model, run, 2));
  EXPECT_GT(reach, spacing / 4);
  EXPECT_LT(reach, spacing);
  run.nearer = 1;
  EXPECT_EQ(accuracy::zone_with_finer_elements(grid.model, run, 2), 2);
}

TEST(FewPressed, is_the_number_of_candidates_that_do_not_resolve_a_contact) {
  const Grid grid(1e-3, above_ball);
  for (int pressed = 0; pressed < 6; ++pressed) {
    contact::Quantities run;
    run.pressed.assign(static_cast<std::size_t>(grid.model.gap.size()), false);
    std::fill_n(run.pressed.begin(), pressed, true);
    EXPECT_EQ(accuracy::few_pressed(grid.model, run),
              pressed > 0 && pressed < 4 ? std::optional(pressed) : std::nullopt);
  }
}

}  // namespace contact_zone_test
