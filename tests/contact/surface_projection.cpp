// SPDX-License-Identifier: BSD-2-Clause
// Surface projections compared with an exhaustive search over all elements.
#include "contact/pairing/surface_projection.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/contact/plate.hpp"
#include "tests/drawn.hpp"

namespace surface_projection_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;

/// Triangles of all sizes and orientations around `origin`. All normals point in the same direction.
WorldSurface soup(int count, const Vector3d& origin) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const auto vector = [&] { return ricochet::test::drawn(normal, random); };
  WorldSurface out;
  for (int t = 0; t < count; ++t) {
    const Vector3d middle = origin + 3 * vector();
    const double size = std::exp2(-t % 6);
    WorldSurface::Element element;
    for (int j = 0; j < 3; ++j) {
      element.corner[static_cast<std::size_t>(j)] = 3 * t + j;
      out.node.emplace_back(middle + size * vector());
      out.normal.emplace_back(Vector3d::UnitZ());
    }
    out.add(element);
  }
  return out;
}

/// Distance from x to a triangle: the minimum over the foot of the perpendicular, the edges and the corners.
double distance(const Vector3d& x, const std::array<Vector3d, 3>& p) {
  double least = std::numeric_limits<double>::infinity();
  for (int j = 0; j < 3; ++j) {
    const Vector3d edge = p[(j + 1) % 3] - p[j];
    const double s = std::min(std::max((x - p[j]).dot(edge) / edge.squaredNorm(), 0.0), 1.0);
    least = std::min(least, (x - p[j] - s * edge).norm());
  }
  Eigen::Matrix3d frame;
  frame << p[1] - p[0], p[2] - p[0], (p[1] - p[0]).cross(p[2] - p[0]);
  const Vector3d foot = frame.fullPivLu().solve(x - p[0]);
  if (foot[0] >= 0 && foot[1] >= 0 && foot[0] + foot[1] <= 1)
    least = std::min(least, std::abs(foot[2]) * frame.col(2).norm());
  return least;
}

/// |t| at which the line x + t d intersects the triangle, or infinity.
double along(const Vector3d& x, const Vector3d& d, const std::array<Vector3d, 3>& p) {
  Eigen::Matrix3d frame;
  frame << p[1] - p[0], p[2] - p[0], -d;
  const Vector3d at = frame.fullPivLu().solve(x - p[0]);
  const bool inside = at[0] >= 0 && at[1] >= 0 && at[0] + at[1] <= 1;
  return inside ? std::abs(at[2]) : std::numeric_limits<double>::infinity();
}

class Places : public testing::TestWithParam<double> {
 protected:
  const Vector3d origin_{GetParam(), -GetParam(), 0};
  const WorldSurface surface_ = soup(300, origin_);
  const SurfaceProjection target_{surface_};
  /// Round-off of positions: a few ulps of the coordinates, amplified by the condition of slender triangles.
  const double round_off_ = 1e-10 + 1e-12 * GetParam();

  template <class Of>
  double least(Of of) const {
    double out = std::numeric_limits<double>::infinity();
    for (const WorldSurface::Element& element : surface_.element) {
      std::array<Vector3d, 3> corner;
      for (std::size_t j = 0; j < 3; ++j)
        corner[j] = surface_.node[static_cast<std::size_t>(element.corner[j])];
      out = std::min(out, of(corner));
    }
    return out;
  }
};

TEST_P(Places, closest_to_a_point_are_those_of_all_elements) {
  for (int k = 0; k < 200; ++k) {
    const Vector3d x = origin_ + 6 * Vector3d::Random();
    const auto found = target_.closest(x);
    ASSERT_TRUE(found);
    EXPECT_NEAR((found->point - x).norm(), least([&](const auto& p) { return distance(x, p); }), round_off_);
  }
}

TEST_P(Places, first_along_a_line_are_those_of_all_elements) {
  int met = 0;
  for (int k = 0; k < 400; ++k) {
    const Vector3d x = origin_ + 3 * Vector3d::Random(), d = Vector3d::Random().normalized();
    const double expected = least([&](const auto& p) { return along(x, d, p); });
    const auto found = target_.first_along(x, d, 10, [](const Projection&) { return true; });
    ASSERT_EQ(found.has_value(), std::isfinite(expected)) << k;
    if (!found) continue;
    ++met;
    EXPECT_NEAR(std::abs(d.dot(found->point - x)), expected,
                1e-5);  // 1e-6 of an element is tolerated beyond its edges
  }
  EXPECT_GT(met, 100);
}

// 1e5: meshes far from the origin of coordinates.
INSTANTIATE_TEST_SUITE_P(NearAndFar, Places, testing::Values(0.0, 1e5));

TEST(SurfaceProjection, without_elements_finds_nothing) {
  const SurfaceProjection target{WorldSurface{}};
  EXPECT_FALSE(target.closest(Vector3d::Zero()));
  EXPECT_FALSE(
      target.first_along(Vector3d::Zero(), Vector3d::UnitX(), 1, [](const Projection&) { return true; }));
}

TEST(SurfaceProjection, of_equal_points_is_the_one_on_the_first_element) {
  const auto kernel = cap(12, 3, 0.3);
  const WorldSurface surface = surface_of({"b", &kernel});
  const SurfaceProjection target(surface);
  for (std::size_t i = 0; i < surface.node.size(); ++i) {  // each node is a corner of several elements
    const auto found = target.closest(surface.node[i]);
    ASSERT_TRUE(found);
    const auto first = std::ranges::find_if(surface.element, [&](const WorldSurface::Element& element) {
      return std::ranges::count(element.corner, static_cast<int>(i)) > 0;
    });
    EXPECT_EQ(found->corner, first->corner);
  }
}

}  // namespace surface_projection_test
