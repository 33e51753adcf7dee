// SPDX-License-Identifier: BSD-2-Clause
// A part of a body without contact points that passes through another body is found, with its depth.
#include "contact/figures/passage_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/contact/cloud.hpp"

namespace passage_check_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A box leans over a lower one: its left edge, where the only contact points are, is nearest, and the face
/// beside it rises by `slope`. It turns about this edge.
class Passage : public ::testing::Test {
 protected:
  Passage() {
    PlacedBody upper{.name = "upper", .kernel = &upper_.kernel};
    upper.rotation = Eigen::AngleAxisd(-slope, Vector3d::UnitY()).toRotationMatrix();
    upper.translation = pivot - upper.rotation * Vector3d(-0.5, 0, -0.15);
    PlacedBody lower{.name = "lower", .kernel = &lower_.kernel};
    lower.translation = {0.5, 0, -0.5};  // its upper face is the plane z = 0
    PairRequest pair{"upper", "lower", {}, {}, {}};
    pair.reach = 0.01;
    model_ = build_model({upper, lower}, {}, {pair}, Vector3d::Zero());
  }

  /// The warnings after the upper box has turned back by an angle, in steps.
  std::vector<std::string> after(double angle) const {
    PassageCheck check(model_);
    constexpr int steps = 200;
    for (int k = 1; k <= steps; ++k) {
      std::vector<RigidMotion> motion(2);
      const double turned = k * angle / steps;
      motion[0].rotation = {0, turned, 0};
      motion[0].centre = pivot;
      motion[0].turn << 0, 0, turned, 0, 0, 0, -turned, 0, 0;
      check.observe(motion, 0.01 * k);
    }
    return check.warnings();
  }

  static constexpr double slope = 0.2, gap = 1e-4;
  const Vector3d pivot{0, 0, gap};
  Cloud upper_{{1, 0.6, 0.3}, 1, 0, 1, false, 0}, lower_{{2, 1.2, 1}, 1, 0, 1, false, 0};
  Model model_;
};

// The face is level after tan 0.2 = 0.203.
TEST_F(Passage, of_a_part_that_stays_outside_is_not_reported) { EXPECT_THAT(after(0.2), IsEmpty()); }

TEST_F(Passage, of_a_part_inside_is_reported_with_its_depth) {
  const double angle = 0.3, deepest = angle * std::cos(slope) - std::sin(slope) - gap;
  const std::vector<std::string> warnings = after(angle);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_THAT(warnings[0], HasSubstr("through lower at t = "));
  double found = 0;
  ASSERT_EQ(std::sscanf(warnings[0].c_str(), "upper passes %lf", &found), 1) << warnings[0];
  // It is looked at after each quarter of an element, of up to 0.3 m.
  EXPECT_GT(found, deepest - 0.25 * 0.3);
  EXPECT_LT(found, deepest + 1e-4);
}

}  // namespace passage_check_test
