// SPDX-License-Identifier: BSD-2-Clause
// Coarsening: contact points at twice their distance, with wider patches of the same surface.
#include "contact/model/coarsening.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/contact/bodies.hpp"

namespace coarsening_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;

/// A flat sheet above a floor. Its only mode is rigid along z, and R is a Gaussian of the distance.
Model sheet_on_floor(const ricochet::kernels::Kernel& bare, ricochet::kernels::Kernel& kernel) {
  kernel = bare;
  const std::size_t m = kernel.surface.size();
  kernel.modes.angular_frequency = {0};
  kernel.modes.decay_rate = {0};
  kernel.surface.components = 1;
  kernel.surface.direction = ricochet::Vector3{0, 0, 1};
  kernel.surface.shape.assign(m, 1);
  kernel.loads.body_force = {0, 0, 1};
  kernel.loads.rotation = {0, 0, 0};
  const auto at = [&](std::size_t i) { return Eigen::Map<const Vector3d>(&kernel.surface.node[3 * i]); };
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = 0; j < m; ++j)
      kernel.surface.residual_flexibility.push_back(std::exp(-10 * (at(i) - at(j)).squaredNorm()));
  kernel.loads.body_force_residual.assign(3 * m, 0);
  return build_model(
      {{.name = "sheet", .kernel = &kernel, .rotation = upside_down(), .translation = {0, 1, 1}}},
      {{.name = "floor", .normal = {0, 0, 1}}}, {PairRequest{"sheet", "floor", {}, {}, {}}}, {0, 0, 0});
}

double nearest(const Model& model) {
  double least = 1e300;
  for (Eigen::Index i = 0; i < model.gap.size(); ++i)
    for (Eigen::Index j = 0; j < i; ++j)
      least = std::min(least, (model.point_a.row(i) - model.point_a.row(j)).norm());
  return least;
}

TEST(Coarsened, points_stand_about_twice_as_far_apart) {
  ricochet::kernels::Kernel kernel;
  for (const auto& [bare, points] : {std::pair{square(16, 16), 17 * 17}, std::pair{square(30, 1), 62}}) {
    const Model fine = sheet_on_floor(bare, kernel), wide = coarsened(fine);
    ASSERT_EQ(fine.gap.size(), points);
    // The distance is less than doubled at edges, where a patch is a mean over points further inside.
    EXPECT_GT(nearest(wide), 1.05 * nearest(fine));
    EXPECT_LT(wide.gap.size(), 0.6 * static_cast<double>(fine.gap.size()));
    EXPECT_GT(wide.gap.size(), 0.15 * static_cast<double>(fine.gap.size()));
    EXPECT_EQ(wide.pairs[0].points, wide.gap.size());
  }
}

TEST(Coarsened, surface_is_as_large_and_moves_rigidly_as_it_did) {
  ricochet::kernels::Kernel kernel;
  const Model fine = sheet_on_floor(square(9, 7), kernel), wide = coarsened(fine);
  EXPECT_NEAR(wide.area.sum(), fine.area.sum(), 1e-13);
  EXPECT_LT((wide.B.array() - fine.B(0, 0)).abs().maxCoeff(), 1e-13);
  EXPECT_LT((wide.gap.array() - 1).abs().maxCoeff(), 1e-13);
  EXPECT_LT((wide.normal.rowwise() - fine.normal.row(0)).cwiseAbs().maxCoeff(), 1e-13);
}

// A uniform pressure acts as the forces λ_i = A_i on the fine patches and λ_I = A_I
// on the wide ones. Both do the same work.
TEST(Coarsened, surface_yields_to_a_uniform_pressure_as_it_did) {
  ricochet::kernels::Kernel kernel;
  const Model fine = sheet_on_floor(square(9, 7), kernel), wide = coarsened(fine);
  const double work = fine.area.dot(fine.R * fine.area);
  EXPECT_NEAR(wide.area.dot(wide.R * wide.area), work, 1e-12 * work);
}

TEST(Coarsened, points_know_the_candidates_that_they_are_made_of) {
  ricochet::kernels::Kernel kernel;
  const Model wide = coarsened(sheet_on_floor(square(9, 7), kernel));
  const Matrix P = wide.bodies[0].selection;
  const auto m = static_cast<Eigen::Index>(kernel.surface.size());
  const Eigen::Map<const Matrix> R(kernel.surface.residual_flexibility.data(), m, m);
  EXPECT_LT((P * R * P.transpose() - wide.R).cwiseAbs().maxCoeff(), 1e-13);
}

// A paraboloid above a floor. The bulge of a fine patch is what its hat makes of the curvature, h²/3 · κ/2
// for h = 1/16. Wide patches have the mean gap of their parts, which does not depend on the choice of
// patches.
TEST(Coarsened, smooth_surface_keeps_its_mean_gaps_and_bulges_more) {
  ricochet::kernels::Kernel kernel;
  Model fine = sheet_on_floor(square(16, 16), kernel);
  const double curvature = 0.02, h = 1.0 / 16;
  for (Eigen::Index i = 0; i < fine.gap.size(); ++i) {
    const Eigen::RowVector2d d = fine.point_a.row(i).head<2>() - Eigen::RowVector2d(0.4, 0.55);
    fine.gap(i) = 1 + 0.5 * curvature * d.squaredNorm() + 0.1 * d.x();
  }
  fine.bulge = Vector::Constant(fine.gap.size(), curvature * h * h / 6);
  const Model wide = coarsened(fine);
  Model mean = fine;
  use_mean_gaps(mean);
  const Model expected = coarsened(mean);
  int inside = 0;
  for (Eigen::Index i = 0; i < wide.gap.size(); ++i) {
    const Vector3d at = wide.point_a.row(i);
    if ((at.head<2>().array() < 2 * h).any() || (at.head<2>().array() > 1 - 2 * h).any()) continue;
    ++inside;
    EXPECT_GT(wide.bulge(i), 2 * fine.bulge(0));
    EXPECT_LT(wide.bulge(i), 8 * fine.bulge(0));
    // Parts lie on either side of the point, unless it has fewer neighbours on one of them.
    EXPECT_NEAR(wide.gap(i) + wide.bulge(i), expected.gap(i), 0.1 * h * 0.5);
  }
  EXPECT_GT(inside, 20);
}

TEST(Coarsened, tilted_face_has_no_bulge_at_its_edges) {
  ricochet::kernels::Kernel kernel;
  Model fine = sheet_on_floor(square(9, 7), kernel);
  for (Eigen::Index i = 0; i < fine.gap.size(); ++i) fine.gap(i) = 1 + 0.3 * fine.point_a(i, 0);
  fine.bulge = Vector::Zero(fine.gap.size());
  fine.bulge(0) = 1e-9;  // otherwise, gaps are those of means
  const Model wide = coarsened(fine);
  EXPECT_LT(wide.bulge.maxCoeff(), 1e-6);
  EXPECT_NEAR(wide.gap.minCoeff(), 1 + 0.3 * fine.point_a.col(0).minCoeff(), 1e-12) << "the edge itself";
}

TEST(Coarsened, point_that_stands_alone_stays) {
  const ricochet::kernels::Kernel one = rod(3, 10), other = rod(3, 10);
  const Model model = build_model(
      {{.name = "a", .kernel = &one, .translation = {-10, 0, 0}}, {.name = "b", .kernel = &other}}, {},
      {PairRequest{"a", "b", Vector3d(1, 0, 0), {}, {}}}, {0, 0, 0});
  const Model same = coarsened(model);
  EXPECT_EQ(same.gap.size(), model.gap.size());
  EXPECT_EQ(same.B, model.B);
  EXPECT_EQ(same.R, model.R);
}

}  // namespace coarsening_test
