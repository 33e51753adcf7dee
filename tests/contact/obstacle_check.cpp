// SPDX-License-Identifier: BSD-2-Clause
// A part without candidates that passes through an obstacle is found, and a flattened body is not.
#include "contact/figures/obstacle_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "contact/figures/summary_observer.hpp"
#include "contact/pairing/rigid_surface.hpp"
#include "tests/contact/plate.hpp"

namespace obstacle_check_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;
using ::testing::Contains;

const std::vector<Obstacle> floor_at_0{{"floor", Vector3d::Zero(), Vector3d(0, 0, 1)}};

/// A rigid plate of 2 m whose candidates are at z = 0, with a flange whose lowest point is at z = `flange`.
Kernel flanged(double flange) {
  Kernel kernel = *plate({.modes = 1, .points = 3});
  kernel.outline = {0, 0, 0, 2, 0, 0, 0, 0, 1, 2, 0, 1, 1, 0.5, flange};
  return kernel;
}

/// Obstacles whose surface is z = 0 under the plate: a box from below, and one around it.
std::vector<Obstacle> box_at_0(bool around) {
  const Vector3d size(9, 9, 3), middle(0, 0, around ? 1.5 : -1.5);
  return {{.name = "floor",
           .point = middle,
           .surface = std::make_shared<const WorldSurface>(rigid_box(size, around))}};
}

/// It falls from 1 mm at 1 m/s and rebounds.
std::vector<std::string> warnings_of(const Kernel& kernel,
                                     const std::vector<Obstacle>& obstacles = floor_at_0) {
  const Model model =
      build_model({{"plate", &kernel, Matrix3d::Identity(), {0, 0, 0.001}, {0, 0, -1}}}, obstacles,
                  {{"plate", "floor", Vector3d(0, 0, -1), {}, {}}}, Vector3d::Zero());
  constexpr double step = 1e-6;
  const auto stepper = make_stepper(model, {.step = step});
  SummaryObserver observer(model, step, 0);
  while (stepper->time() < 5e-3) {
    EXPECT_EQ(stepper->step(), StepStatus::ok);
    observer.observe(*stepper);
  }
  EXPECT_EQ(observer.summary().episodes.size(), 1U);
  return observer.summary().warnings;
}

TEST(Obstacle, that_a_part_without_candidates_passes_is_named_with_the_depth) {
  // The plate stops at z = 0, up to the flattening: 1 m/s √(m R/3) = 0.26 mm.
  EXPECT_THAT(warnings_of(flanged(-0.01)),
              Contains(AllOf(HasSubstr("plate passes 0.0103"), HasSubstr("m through floor at t = 0.00"),
                             HasSubstr("[1, 0.5, -0.009]"))));
  EXPECT_THAT(warnings_of(flanged(0.001)), IsEmpty());
}

// Looks are as far apart as the depth that does not count, 1e-3 of 2.3 m: in the fall of 1 mm, the first one
// counts.
TEST(Obstacle, with_a_surface_that_a_part_passes_is_named_like_a_half_space) {
  for (const bool around : {false, true}) {
    EXPECT_THAT(
        warnings_of(flanged(-0.02), box_at_0(around)),
        Contains(AllOf(HasSubstr("plate passes 0.019 m through floor"), HasSubstr("[1, 0.5, -0.019]"))));
    EXPECT_THAT(warnings_of(flanged(0.001), box_at_0(around)), IsEmpty());
  }
}

// Candidates approach by 0.26 mm, and so does every other point of a rigid plate.
TEST(Obstacle, that_only_flattens_the_body_is_not_named) {
  Kernel kernel = flanged(0);
  for (double& x : kernel.outline) x *= 0.01;  // 1e-3 of the size is then 20 µm only
  EXPECT_THAT(warnings_of(kernel), IsEmpty());
}

TEST(Obstacle, that_a_turned_body_passes_is_found_from_its_rigid_motion) {
  Kernel kernel = flanged(0);
  kernel.centre = {1, 0, 0};
  kernel.inertia = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  // Two rigid modes: z, and the rotation about y with unit inertia.
  kernel.modes.angular_frequency.push_back(0);
  kernel.modes.decay_rate.push_back(0);
  kernel.surface.shape = {1 / std::sqrt(2), 1, 1 / std::sqrt(2), 0, 1 / std::sqrt(2), -1};
  kernel.loads.body_force = {0, 0, 0, 0, std::sqrt(2), 0};
  kernel.loads.rotation = {0, 0, -std::sqrt(2), 1, 0, 0};  // e_y × … about the origin: centre × p
  const Model model = build_model({{"plate", &kernel, Matrix3d::Identity(), {0, 0, 0.001}}}, floor_at_0,
                                  {{"plate", "floor", {}, {}, {}}}, Vector3d::Zero());
  ObstacleCheck check(model);
  Vector q = Vector::Zero(2);
  check.observe(RigidMotions(model).of(q), 0);
  EXPECT_THAT(check.warnings(), IsEmpty());
  // 10 cm up, and turned by 0.2 about y: the candidate at x = 2 would sink to 0.1 − 0.2 + 0.001, as allowed,
  // but not the point of the outline that is three times as far out.
  q << 0.1 * std::sqrt(2), 0.2;
  check.observe(RigidMotions(model).of(q), 0.5);
  EXPECT_THAT(check.warnings(), IsEmpty());
  kernel.outline.insert(kernel.outline.end(), {4, 0, 0});
  ObstacleCheck longer(model);
  longer.observe(RigidMotions(model).of(q), 0.5);
  // 0.1 + 0.001 − 0.2 · 3
  EXPECT_THAT(longer.warnings(), Contains(HasSubstr("plate passes 0.499 m through floor at t = 0.5 s")));
}

// Nodes of a rounded surface lie below the points from which gaps are measured.
TEST(Obstacle, that_nodes_enter_by_twice_the_bulge_of_their_patches_is_not_named) {
  Kernel kernel = flanged(-0.01);
  for (const double bulge : {0.0051, 0.003}) {
    kernel.surface.bulge.assign(kernel.surface.size(), bulge);
    kernel.surface.centroid = kernel.surface.node;
    const Model model = build_model({{"plate", &kernel, Matrix3d::Identity(), {0, 0, 0.001}}}, floor_at_0,
                                    {{"plate", "floor", {}, {}, {}}}, Vector3d::Zero());
    ObstacleCheck check(model);
    check.observe(RigidMotions(model).of(Vector::Zero(1)), 0);
    // The flange starts 9 mm below the floor; 1e-3 of the size of the plate is 2.3 mm.
    if (bulge > 0.004) {
      EXPECT_THAT(check.warnings(), IsEmpty());
    } else {
      EXPECT_THAT(check.warnings(), Contains(HasSubstr("plate passes 0.009 m through floor")));
    }
  }
}

TEST(Obstacle, that_is_nearer_than_all_contact_points_at_the_start_is_named_with_the_figures) {
  Kernel ball = cap(4, 1, 0.5);
  for (const std::int64_t i : ball.surface.element)
    for (int d = 0; d < 3; ++d) ball.surface.element_normal.push_back(ball.surface.normal[3 * i + d]);
  ball.surface.shape.assign(3 * ball.surface.size(), 0);
  ball.modes.angular_frequency = {1};
  ball.modes.decay_rate = {0};
  ball.loads.body_force.assign(3, 0);
  ball.loads.rotation.assign(3, 0);
  // Turned by half an interval about y, so that the lowest point lies between candidates.
  const Matrix3d Q = turn(0.12, {0, 1, 0}) * upside_down();
  const Model model = build_model({{"ball", &ball, Q, {0, 0, 1.001}}}, floor_at_0,
                                  {{"ball", "floor", {}, {}, {}}}, Vector3d::Zero());
  ASSERT_TRUE(model.pairs[0].apart);
  EXPECT_NEAR(model.pairs[0].apart->distance, 0.001, 2e-4);
  EXPECT_GT(model.pairs[0].initial_gap, 0.005);
  EXPECT_THAT(ObstacleCheck(model).warnings(),
              Contains(AllOf(HasSubstr("ball and floor start 0.00"), HasSubstr("so they touch late by 0.0"),
                             HasSubstr("bodies.ball.geometry"))));
}

/// A box of three edges from `low` with the normals of its faces, as a rigid free body that moves along the
/// axes.
Kernel brick(const std::vector<std::pair<Vector3d, Vector3d>>& boxes) {
  Kernel kernel;
  kernel.mass = 1;
  for (const auto& [low, size] : boxes)
    for (int d = 0; d < 3; ++d)
      for (const double side : {0.0, 1.0}) {
        const int e = (d + 1) % 3, f = (d + 2) % 3;
        const Vector3d normal = (2 * side - 1) * Vector3d::Unit(d);
        const auto first = static_cast<std::int64_t>(kernel.surface.size());
        for (const auto& [s, t] :
             {std::pair(0.0, 0.0), std::pair(1.0, 0.0), std::pair(1.0, 1.0), std::pair(0.0, 1.0)}) {
          Vector3d at;
          at[d] = side;
          at[e] = s;
          at[f] = t;
          add_candidate(kernel, low + at.cwiseProduct(size), normal, 1);
        }
        for (const std::int64_t k : {0, 1, 2, 0, 2, 3}) {
          kernel.surface.element.push_back(first + k);
          kernel.surface.element_normal.insert(kernel.surface.element_normal.end(), normal.begin(),
                                               normal.end());
        }
      }
  kernel.inertia = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  kernel.modes.angular_frequency = {0, 0, 0};
  kernel.modes.decay_rate = {0, 0, 0};
  kernel.loads.body_force = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  kernel.loads.rotation.assign(9, 0);
  for (std::size_t i = 0; i < kernel.surface.size(); ++i)
    kernel.surface.shape.insert(kernel.surface.shape.end(), {1, 0, 0, 0, 1, 0, 0, 0, 1});
  return kernel;
}

// A brick glides over a plate, towards a post on it that no pair along z knows of.
TEST(Bodies, that_pass_through_each_other_without_contact_points_are_named_with_the_depth) {
  const Kernel stone = brick({{{0, 0, 0}, {0.2, 0.2, 0.2}}}),
               plate = brick({{{-1, -1, -0.1}, {2, 2, 0.1}}, {{0.5, -0.5, 0}, {0.3, 1.1, 1}}});
  const Model model = build_model(
      {{"stone", &stone, Matrix3d::Identity(), {0, 0, 0.05}}, {"plate", &plate, Matrix3d::Identity()}}, {},
      {{"stone", "plate", Vector3d(0, 0, -1), {}, {}}}, Vector3d::Zero());
  ObstacleCheck check(model);
  Vector q = Vector::Zero(6);
  for (const double way : {0.0, 0.1, 0.2, 0.29}) {
    q(0) = way;
    check.observe(RigidMotions(model).of(q), way);
    EXPECT_THAT(check.warnings(), IsEmpty()) << way;
  }
  q(0) = 0.38;
  check.observe(RigidMotions(model).of(q), 0.38);
  EXPECT_THAT(check.warnings(), Contains(HasSubstr("stone passes 0.08 m through plate at t = 0.38 s")));
}

}  // namespace obstacle_check_test
