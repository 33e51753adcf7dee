// SPDX-License-Identifier: BSD-2-Clause
// Coarsening: contact points at twice their distance, with wider patches of the same surface.
#include "contact/model/coarsening.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

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
  const Matrix P = wide.selection[0];
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

/// A rigid wedge of two squares, {y ≥ 0, z = 0} below and {y = 0, z ≥ 0} at its side, which meet in a crease
/// along x. The candidates of the crease, 1/n apart, come last.
Kernel wedge(int n) {
  Kernel kernel;
  kernel.mass = 1;
  kernel.inertia = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::map<std::array<int, 3>, std::int64_t> number;  // of x, of the face (0 for the crease) and along it
  const auto at = [&](int i, int face, int j) -> Vector3d {
    return Vector3d(i, face == 1 ? j : 0, face == 2 ? j : 0) / n;
  };
  const std::array<Vector3d, 3> normal{Vector3d(0, -1, -1), Vector3d(0, 0, -1), Vector3d(0, -1, 0)};
  for (const int face : {1, 2, 0})
    for (int j = n; j >= 1; --j)
      for (int i = 0; i <= n; ++i)
        if (face != 0 || j == 1) {
          number[{i, face, face == 0 ? 0 : j}] = static_cast<std::int64_t>(number.size());
          add_candidate(kernel, at(i, face, j), normal[face], 1.0 / (n * n));
        }
  for (const int face : {1, 2})
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        for (const auto& [di, dj] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 0}, {1, 1}, {0, 1}}) {
          kernel.surface.element.push_back(number.at({i + di, j + dj == 0 ? 0 : face, j + dj}));
          for (int d = 0; d < 3; ++d) kernel.surface.element_normal.push_back(normal[face][d]);
        }
  for (int k = 0; k < 6; ++k) kernel.modes.angular_frequency.push_back(0);
  kernel.modes.decay_rate.assign(6, 0);
  const auto field = [](int k, const Vector3d& x) -> Vector3d {
    return k < 3 ? Vector3d::Unit(k) : Vector3d(Vector3d::Unit(k - 3).cross(x));
  };
  for (std::size_t i = 0; i < kernel.surface.size(); ++i)
    for (int d = 0; d < 3; ++d)
      for (int k = 0; k < 6; ++k)
        kernel.surface.shape.push_back(field(k, Eigen::Map<const Vector3d>(&kernel.surface.node[3 * i]))(d));
  for (std::size_t d = 0; d < 3; ++d)
    for (std::size_t k = 0; k < 6; ++k) {
      kernel.loads.body_force.push_back(k == d ? 1 : 0);
      kernel.loads.rotation.push_back(k == d + 3 ? 1 : 0);
    }
  return kernel;
}

// The mean of points of both faces would lie inside the wedge, above the floor that its edge touches.
TEST(Coarsened, edge_of_a_tilted_body_stays_an_edge_with_its_lever_arms) {
  const Kernel kernel = wedge(8);
  const Matrix3d Q = turn(0.2, {1, 0, 0});
  const Model fine = build_model({{.name = "wedge", .kernel = &kernel, .rotation = Q}},
                                 {{.name = "floor", .point = {0, 0, -0.01}, .normal = {0, 0, 1}}},
                                 {PairRequest{"wedge", "floor", {}, {}, {}}}, {0, 0, 0});
  EXPECT_EQ(std::ranges::count(fine.faces, 2), 9);
  EXPECT_EQ(std::ranges::count(fine.faces, 1), fine.gap.size() - 9);
  for (const auto& [times, left] : {std::pair{1, 5}, {2, 3}}) {  // of the nine points of the edge
    const Model wide = coarsened(fine, times);
    int on_edge = 0;
    for (Eigen::Index i = 0; i < wide.gap.size(); ++i) {
      const Vector3d x = wide.point_a.row(i), own = Q.transpose() * x, down(0, 0, -1);
      EXPECT_LT(std::min(std::abs(own.y()), std::abs(own.z())), 1e-12) << "on a face: " << own.transpose();
      EXPECT_NEAR(wide.gap(i), x.z() + 0.01, 1e-6);  // the weight of curvature in the fit
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(wide.B(i, k), down.dot(Q * Vector3d::Unit(k)), 1e-12);
        EXPECT_NEAR(wide.B(i, 3 + k), down.dot(Q * Vector3d::Unit(k).cross(own)), 1e-12);
      }
      on_edge += std::max(own.y(), own.z()) < 1e-12 ? 1 : 0;
    }
    EXPECT_EQ(on_edge, left);
  }
}

// Of two neighbours, the first one is kept unless more faces meet at the other.
TEST(Coarsened, points_where_more_faces_meet_are_kept) {
  Kernel kernel;
  Model fine = sheet_on_floor(square(9, 7), kernel);
  EXPECT_THAT(fine.faces, ::testing::Each(1));
  for (const std::size_t corner : {std::size_t{0}, std::size_t{1}, std::size_t{35}}) {
    Model marked = fine;
    marked.faces[corner] = 3;
    const Model wide = coarsened(marked);
    EXPECT_EQ(std::ranges::count(wide.faces, 3), 1) << corner;
  }
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
