// SPDX-License-Identifier: BSD-2-Clause
// Smaller elements near the points that were pressed, and when the accuracy loop asks for them.
#include "src/accuracy/local_refinement.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "src/accuracy/decision.hpp"
#include "src/accuracy/mesh_levels.hpp"
#include "src/scene/scene.hpp"

namespace local_refinement_test {

using namespace ricochet;
using accuracy::balls_near_contact;
using accuracy::BodySize;
using accuracy::decide;
using accuracy::Decision;
using contact::Cause;

/// Distance of the candidates of `round_of` [m].
constexpr double next = 1e-3;

/// A body of a geometry whose elements are open, and another one of the same drawing.
scene::Scene scene_of_two() {
  scene::Scene scene;
  scene.accuracy = 1e-2;
  for (const char* name : {"upper", "lower"}) {
    scene::Body& body = scene.bodies.emplace_back();
    body.name = name;
    body.mesh = "part.step";
    body.order_open = body.size_open = body.refine_open = true;
  }
  scene::Pair& pair = scene.contact.pairs.emplace_back();
  pair.a = "upper";
  pair.b = "lower";
  return scene;
}

accuracy::Settings first_round(const scene::Scene& scene) {
  accuracy::Settings settings;
  settings.found.mesh = accuracy::meshes_at(scene, 0);
  settings.found.basis = scene::Basis::modes;
  settings.found.up_to = Hertz{1e4};
  settings.found.flexibility_error = 0.1;
  settings.rate = Hertz{1e6};
  settings.pilot = true;
  return settings;
}

/// The surface of `round_of`, of 40 points.
const kernels::Kernel kernel_of_a_solid = [] {
  kernels::Kernel kernel;
  kernel.surface.area.assign(40, next * next);
  return kernel;
}();

/// A round in which `pressed` of 40 points on a line were pressed, of two bodies: the upper one was moved by
/// 1 m along x and turned by 90° about z, the lower one was not moved. Gaps grow along the line.
contact::Dialled round_of(int pressed, const std::map<Cause, double>& shares) {
  constexpr int points = 40;
  contact::Dialled round;
  contact::Model& model = round.model;
  model.omega = contact::Vector::Zero(10);
  model.gap = contact::Vector::LinSpaced(points, 0, 1e-4);
  model.area = contact::Vector::Constant(points, next * next);
  model.point_a = contact::Matrix::Zero(points, 3);
  for (int i = 0; i < points; ++i) model.point_a(i, 1) = i * next;
  model.point_b = model.point_a;
  for (const char* name : {"upper", "lower"}) {
    contact::Bodies::Block& body = model.bodies.emplace_back();
    body.name = name;
    body.kernel = &kernel_of_a_solid;
    body.rotation.setIdentity();
    body.translation.setZero();
  }
  model.bodies[0].rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  model.bodies[0].translation << 1, 0, 0;
  model.pairs.push_back({.first_point = 0, .points = points, .a = 0, .b = 1, .reach = {}});
  round.quantities.emplace();
  round.quantities->pressed.assign(points, false);
  for (int i = 0; i < pressed; ++i) round.quantities->pressed[static_cast<std::size_t>(i)] = true;
  round.quantities->nearer = 1e-5;
  round.estimate.emplace();
  round.estimate->requested = {Quantity::impulse};
  for (const auto& [cause, share] : shares)
    round.estimate->by_cause[cause] = contact::Errors{{Quantity::impulse, share}};
  return round;
}

const std::vector<BodySize> small{{"upper", 10, 1e3, 5e2}, {"lower", 10, 1e3, 5e2}};

// The point 2 mm along y lies there in the lower body. The upper one was turned and moved: x = Rᵀ (y − 1, …).
TEST(Balls, lie_at_the_pressed_points_in_the_axes_of_the_mesh) {
  const scene::Scene scene = scene_of_two();
  const auto balls = balls_near_contact(scene, accuracy::meshes_at(scene, 0), round_of(3, {}), 2);
  ASSERT_EQ(balls.size(), 2U);
  // Two in each body, and those of the other body, because one mesh serves both.
  ASSERT_EQ(balls.at("lower").size(), 4U);
  EXPECT_EQ(balls.at("lower"), balls.at("upper"));
  const auto holds = [&](double x, double y) {
    return std::ranges::any_of(balls.at("lower"), [&](const scene::FineBall& ball) {
      return std::hypot(ball.at[0] - x, ball.at[1] - y, ball.at[2]) < next / 100;
    });
  };
  EXPECT_TRUE(holds(0, 2 * next));
  EXPECT_TRUE(holds(2 * next, 1));
  EXPECT_FALSE(holds(0, 3 * next));
}

// Elements of order 2 have two candidates along an edge.
TEST(Balls, halve_the_distance_of_candidates_or_quarter_it_if_few_are_pressed) {
  const scene::Scene scene = scene_of_two();
  const auto ball = [&](int pressed, double wanted = 2) {
    const auto balls =
        balls_near_contact(scene, accuracy::meshes_at(scene, 0), round_of(pressed, {}), wanted);
    return balls.at("lower")[0];
  };
  EXPECT_NEAR(ball(2).size, 2 * next / 4, 1e-9);
  EXPECT_NEAR(ball(2).radius, next, 1e-9);
  EXPECT_NEAR(ball(3).size, 2 * next / 2, 1e-9);
  EXPECT_NEAR(ball(3).radius, 2 * next, 1e-9);
  EXPECT_NEAR(ball(3, 4).size, 2 * next / 4, 1e-9);
}

// A ball reaches one distance beyond the points that it serves: two of a line, then the next two.
TEST(Balls, are_as_few_as_reach_one_distance_beyond_every_pressed_point) {
  scene::Scene scene = scene_of_two();
  scene.bodies[1].mesh = "other.step";
  const int pressed = 9;
  const auto balls =
      balls_near_contact(scene, accuracy::meshes_at(scene, 0), round_of(pressed, {}), 2).at("lower");
  EXPECT_EQ(balls.size(), 5U);
  for (int i = 0; i < pressed; ++i)
    EXPECT_TRUE(std::ranges::any_of(balls, [&](const scene::FineBall& ball) {
      return std::abs(ball.at[1] - i * next) + next <= 1.2 * ball.radius;
    })) << i;
}

TEST(Balls, are_not_for_bodies_or_candidates_that_a_scene_gives) {
  scene::Scene scene = scene_of_two();
  scene.bodies[1].refine_open = false;
  const auto balls = balls_near_contact(scene, accuracy::meshes_at(scene, 0), round_of(3, {}), 2);
  EXPECT_EQ(balls.size(), 1U);
  EXPECT_EQ(balls.count("upper"), 1U);
  scene.contact.pairs[0].spacing = 1e-3;
  EXPECT_TRUE(balls_near_contact(scene, accuracy::meshes_at(scene, 0), round_of(3, {}), 2).empty());
  EXPECT_TRUE(balls_near_contact(scene_of_two(), {}, round_of(0, {}), 2).empty());
}

// A cube of side 1 that is filled with elements of size s has 6 s⁻³ to 12 s⁻³ tetrahedra (of gmsh: 1.1·10⁴ at
// s = 0.1), so order³/6 nodes an element give 3·10³ to 6·10³ unknowns for order 1. Half of a ball counts.
TEST(Unknowns, of_balls_are_those_of_tetrahedra) {
  const double radius = std::cbrt(3 / (2 * std::numbers::pi));
  EXPECT_NEAR(accuracy::unknowns_in({{.at = {}, .radius = radius, .size = 0.1}}, 1, 0), 4.5e3, 1.5e3);
}

// A steel ball of 20 mm whose poles have elements of 1.35 mm and order 3 has 38 889 unknowns of gmsh, and
// 2075 without them. Two equal balls count once.
TEST(Unknowns, of_elements_that_grow_around_balls_are_those_of_gmsh) {
  const std::vector<scene::FineBall> poles{{.at = {0, 0, 0.01}, .radius = 2.7e-3, .size = 1.35e-3},
                                           {.at = {0, 0, -0.01}, .radius = 2.7e-3, .size = 1.35e-3}};
  const double both = accuracy::unknowns_in(poles, 3, 15e-3);
  EXPECT_NEAR(both, 36814, 0.3 * 36814);
  EXPECT_NEAR(accuracy::unknowns_in({poles[0], poles[0]}, 3, 15e-3), both / 2, 0.1 * both);
}

TEST(Decision, makes_elements_smaller_where_a_small_part_is_pressed) {
  const scene::Scene scene = scene_of_two();
  const std::map<Cause, double> shares{{Cause::mesh, 1e-4}, {Cause::modes, 1e-4}, {Cause::spacing, 0.1}};
  const Decision local = decide(scene, first_round(scene), round_of(4, shares), small);
  ASSERT_TRUE(local.next);
  EXPECT_EQ(local.reason, "spacing");
  EXPECT_EQ(local.next->found.mesh.at("upper").refine.size(), 4U);
  EXPECT_EQ(local.next->found.mesh.at("upper").order, accuracy::meshes_at(scene, 0).at("upper").order);
  EXPECT_DOUBLE_EQ(local.next->found.zone.value_or(0), 2e-5);  // twice as far as the bodies came nearer
  const Decision flat = decide(scene, first_round(scene), round_of(40, shares), small);
  ASSERT_TRUE(flat.next);
  EXPECT_EQ(flat.reason, "mesh");
  EXPECT_TRUE(flat.next->found.mesh.at("upper").refine.empty());
}

// Half of the distance is expected to leave a third of the share: 0.005 of 0.015, and more of 0.02.
TEST(Decision, quarters_the_distance_of_candidates_where_half_of_it_does_not_suffice) {
  const scene::Scene scene = scene_of_two();
  const auto size = [&](double share) {
    const auto round = round_of(4, {{Cause::mesh, 1e-4}, {Cause::spacing, share}});
    return decide(scene, first_round(scene), round, small).next.value().found.mesh.at("lower").refine[0].size;
  };
  EXPECT_NEAR(size(0.02), size(0.0149) / 2, 1e-9);
}

// Elements near contact that cost less than an order, which they make unnecessary.
TEST(Decision, keeps_the_order_where_elements_near_contact_suffice) {
  const scene::Scene scene = scene_of_two();
  auto round = round_of(4, {{Cause::mesh, 0.018}, {Cause::spacing, 0.01}});
  round.mesh_near_contact = contact::Errors{{Quantity::impulse, 0.01}};
  const Decision found = decide(scene, first_round(scene), round, small);
  EXPECT_EQ(found.reason, "spacing");
}

/// Settings of a round whose elements near contact were the last to become smaller.
accuracy::Settings after_local(const scene::Scene& scene, int level = 1) {
  accuracy::Settings settings = first_round(scene);
  settings.pilot = false;
  settings.found.zone = 2e-5;
  settings.found.mesh = accuracy::meshes_at(scene, level);
  for (auto& [body, mesh] : settings.found.mesh) mesh.refine = {{.at = {}, .radius = 1e-2, .size = 5e-3}};
  return settings;
}

TEST(Decision, refines_a_sharp_edge_on_which_touches_repeat_once_and_says_why) {
  const scene::Scene scene = scene_of_two();
  auto round = round_of(4, {{Cause::mesh, 1e-4}});
  round.estimate->by_cause[Cause::spacing] = std::nullopt;
  round.on_sharp_edge = true;
  accuracy::Settings settings = first_round(scene);
  settings.pilot = true;
  EXPECT_EQ(decide(scene, settings, round, small).reason, "spacing");
  for (const double mesh : {1e-4, 0.02}) {  // what could still be refined makes no difference
    round.estimate->by_cause[Cause::mesh] = contact::Errors{{Quantity::impulse, mesh}};
    const Decision found = decide(scene, after_local(scene), round, small);
    EXPECT_FALSE(found.next);
    EXPECT_EQ(found.reason,
              "the share of the spacing is unknown: touches repeat on a sharp edge, which yields the more, "
              "the smaller its elements");
  }
}

// The share of the mesh is that of elements near contact if the flexibility there has most of it.
TEST(Decision, refines_the_elements_to_which_the_share_of_the_mesh_is_due) {
  const scene::Scene scene = scene_of_two();
  const accuracy::Settings settings = after_local(scene);
  contact::Dialled round = round_of(4, {{Cause::mesh, 0.05}, {Cause::spacing, 1e-3}});
  round.mesh_near_contact = contact::Errors{{Quantity::impulse, 1e-3}};
  const Decision everywhere = decide(scene, settings, round, small);
  ASSERT_TRUE(everywhere.next);
  EXPECT_EQ(everywhere.reason, "mesh");
  EXPECT_GT(everywhere.next->found.mesh.at("upper").order, settings.found.mesh.at("upper").order);
  EXPECT_EQ(everywhere.next->found.mesh.at("upper").refine, settings.found.mesh.at("upper").refine);
  round.mesh_near_contact = contact::Errors{{Quantity::impulse, 0.049}};
  const Decision near = decide(scene, settings, round, small);
  ASSERT_TRUE(near.next);
  EXPECT_EQ(near.reason, "spacing");
  EXPECT_EQ(near.next->found.mesh.at("upper").order, settings.found.mesh.at("upper").order);
  EXPECT_NE(near.next->found.mesh.at("upper").refine, settings.found.mesh.at("upper").refine);
}

// Four candidates and more resolve a contact; fewer do not, whatever their share says. At a corner, there are
// never more.
TEST(Decision, makes_elements_smaller_until_four_candidates_touch_but_not_for_ever) {
  const scene::Scene scene = scene_of_two();
  const auto round = round_of(1, {{Cause::mesh, 1e-4}, {Cause::spacing, 2e-3}});
  accuracy::Settings settings = after_local(scene);
  std::vector<BodySize> sizes = small;
  int rounds = 0;
  for (;; ++rounds) {
    const Decision found = decide(scene, settings, round, sizes);
    if (!found.next) break;
    EXPECT_EQ(found.reason, "spacing");
    settings = *found.next;
    for (auto& [body, mesh] : settings.found.mesh)
      mesh.refine[0].size *= 3;  // so that other ones are asked for
    for (BodySize& size : sizes) {
      size.unknowns *= 1.1;
      ++size.elements;
    }
    ASSERT_LT(rounds, 9);
  }
  EXPECT_EQ(rounds, 3);
  EXPECT_FALSE(
      decide(scene, after_local(scene), round_of(4, {{Cause::mesh, 1e-4}, {Cause::spacing, 2e-3}}), small)
          .next);
  // A tenth of the accuracy leaves room for what one candidate does not show.
  EXPECT_FALSE(
      decide(scene, after_local(scene), round_of(1, {{Cause::mesh, 1e-4}, {Cause::spacing, 5e-4}}), small)
          .next);
}

TEST(Decision, does_not_ask_for_the_same_elements_again) {
  const scene::Scene scene = scene_of_two();
  const auto round = round_of(4, {{Cause::mesh, 1e-4}, {Cause::spacing, 0.1}});
  accuracy::Settings settings = after_local(scene);
  for (auto& [body, balls] : balls_near_contact(scene, settings.found.mesh, round, 4))
    settings.found.mesh[body].refine = balls;
  EXPECT_EQ(decide(scene, settings, round, small).reason, "mesh");
}

// With 10⁵ modes, the unknowns of the balls of three points are too much.
TEST(Decision, does_not_ask_for_more_elements_near_contact_than_are_affordable) {
  const scene::Scene scene = scene_of_two();
  const auto round = round_of(4, {{Cause::mesh, 1e-4}, {Cause::spacing, 0.1}});
  EXPECT_TRUE(decide(scene, after_local(scene), round, small).next);
  EXPECT_FALSE(
      decide(scene, after_local(scene), round, {{"upper", 1e5, 2e5, 1e5}, {"lower", 1e5, 2e5, 1e5}}).next);
}

// Of 40 candidates in the zone, elements of half the size make 160. Of 600, they make 2400.
TEST(Decision, does_not_ask_for_more_candidates_than_are_affordable) {
  const scene::Scene scene = scene_of_two();
  accuracy::Settings settings = after_local(scene);
  auto round = round_of(4, {{Cause::mesh, 1e-4}, {Cause::spacing, 0.1}});
  round.quantities->nearer = 1;
  EXPECT_EQ(decide(scene, settings, round, small).reason, "spacing");
  contact::Model& model = round.model;
  model.gap.conservativeResizeLike(contact::Vector::Zero(600));
  model.area.conservativeResizeLike(contact::Vector::Constant(600, next * next));
  for (contact::Matrix* points : {&model.point_a, &model.point_b}) {
    points->conservativeResizeLike(contact::Matrix::Zero(600, 3));
    for (int i = 0; i < 600; ++i) (*points)(i, 1) = i * next;
  }
  model.pairs[0].points = 600;
  round.quantities->pressed.resize(600, false);
  EXPECT_EQ(decide(scene, settings, round, small).reason, "mesh");
}

}  // namespace local_refinement_test
