// SPDX-License-Identifier: BSD-2-Clause
// A part without candidates that passes through an obstacle is found, and a flattened body is not.
#include "contact/output/obstacle_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "contact/output/summary_observer.hpp"
#include "tests/contact/plate.hpp"

namespace obstacle_check_test {

using namespace ricochet::contact;
using ricochet::StepStatus;
using namespace ricochet::contact::test;
using ricochet::kernels::Kernel;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

const std::vector<HalfSpace> floor_at_0{{"floor", Vector3d::Zero(), Vector3d(0, 0, 1)}};

/// A rigid plate of 2 m whose candidates are at z = 0, with a flange whose lowest point is at z = `flange`.
Kernel flanged(double flange) {
  Kernel kernel = *plate({.modes = 1, .points = 3});
  kernel.outline = {0, 0, 0, 2, 0, 0, 0, 0, 1, 2, 0, 1, 1, 0.5, flange};
  return kernel;
}

/// It falls from 1 mm at 1 m/s and rebounds.
std::vector<std::string> warnings_of(const Kernel& kernel) {
  const Model model = build_model({{"plate", &kernel, Matrix3d::Identity(), {0, 0, 0.001}, {0, 0, -1}}},
                                  floor_at_0, {{"plate", "floor", {}, {}, {}}}, Vector3d::Zero());
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
  check.observe(q, 0);
  EXPECT_THAT(check.warnings(), IsEmpty());
  // 10 cm up, and turned by 0.2 about y: the candidate at x = 2 would sink to 0.1 − 0.2 + 0.001, as allowed,
  // but not the point of the outline that is three times as far out.
  q << 0.1 * std::sqrt(2), 0.2;
  check.observe(q, 0.5);
  EXPECT_THAT(check.warnings(), IsEmpty());
  kernel.outline.insert(kernel.outline.end(), {4, 0, 0});
  ObstacleCheck longer(model);
  longer.observe(q, 0.5);
  // 0.1 + 0.001 − 0.2 · 3
  EXPECT_THAT(longer.warnings(), Contains(HasSubstr("plate passes 0.499 m through floor at t = 0.5 s")));
}

// The first of many candidates of a curved surface may lie below its mean.
TEST(Obstacle, that_the_mesh_of_the_contact_surface_enters_at_the_start_is_not_named) {
  Kernel kernel = flanged(-0.01);
  kernel.surface.centroid = kernel.surface.node;
  for (std::size_t i = 2; i < kernel.surface.node.size(); i += 3) kernel.surface.node[i] = -0.012;
  EXPECT_THAT(warnings_of(kernel), Not(Contains(HasSubstr("passes"))));
}

}  // namespace obstacle_check_test
