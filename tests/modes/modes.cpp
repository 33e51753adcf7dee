// SPDX-License-Identifier: BSD-2-Clause
// Modes compared with closed forms of the discrete problem and with dense eigenvalues.
#include "src/modes/modes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "src/reduction/residual.hpp"
#include "tests/cubes.hpp"
#include "tests/meshes.hpp"
#include "tests/modes/dense.hpp"

namespace ricochet {
namespace modes_test {

using std::numbers::pi;

struct Made {
  mesh::Mesh mesh;
  elasticity::Body body;
  std::unique_ptr<modes::Factorisation> factor;
};

Made make(const std::string& geo, int order, const std::map<std::string, std::string>& support = {},
          const parallel::Teams& teams = test::one_team()) {
  const test::SharedFile file(".geo", geo);
  scene::Body given = test::body_of(file.path(), order);
  given.support = support;
  Made made{test::mesh_of(given, teams), {}, {}};
  made.body = elasticity::assemble(made.mesh, given.materials, "test");
  made.factor = std::make_unique<modes::Factorisation>(made.body.stiffness, made.body.mass);
  return made;
}

/// Dispersion relation of a mesh of linear elements of length h with
/// consistent mass: ω for the wave number κ.
double discrete_omega(double kappa, double h, double young, double density) {
  const double c = std::cos(kappa * h);
  return std::sqrt(6 * young / (density * h * h) * (1 - c) / (2 + c));
}

TEST(Rod, if_free_has_the_frequencies_of_its_mesh_in_closed_form) {
  const mesh::GmshSession gmsh;
  const int n = 40;
  const Made rod = make(test::rod_geo(n), 1);
  const modes::ModeSet set =
      modes::compute_modes(test::one_team(), rod.mesh, rod.body, *rod.factor, {.count = n + 1});
  ASSERT_EQ(set.angular_frequency.size(), static_cast<std::size_t>(n + 1));
  EXPECT_EQ(set.angular_frequency[0], 0);
  for (int k = 1; k <= n; ++k)
    // λ is accurate to about the round-off of the largest eigenvalue, which is 1e4 times the smallest.
    EXPECT_NEAR(set.angular_frequency[k] / discrete_omega(k * pi / 2, 2.0 / n, 3.0, 2.0), 1, 1e-10) << k;
}

TEST(Rod, if_clamped_has_the_frequencies_of_its_mesh_in_closed_form) {
  const mesh::GmshSession gmsh;
  const int n = 40;
  const Made rod = make(test::rod_geo(n), 1, {{"left", "x"}});
  const modes::ModeSet set =
      modes::compute_modes(test::one_team(), rod.mesh, rod.body, *rod.factor, {.count = 20});
  for (int k = 0; k < 20; ++k)
    EXPECT_NEAR(set.angular_frequency[k] / discrete_omega((k + 0.5) * pi / 2, 2.0 / n, 3.0, 2.0), 1, 1e-10)
        << k;
}

class FreeBody : public testing::TestWithParam<const char*> {
 protected:
  static std::string geo() {
    return GetParam() == std::string("prism") ? test::prism_geo(2) : test::block_geo(GetParam(), 2, 0.3);
  }
};

TEST_P(FreeBody, has_exactly_six_rigid_modes) {
  const mesh::GmshSession gmsh;
  const Made made = make(geo(), 2);
  const Eigen::VectorXd exact = test::dense_eigenvalues(made.mesh, made.body);
  ASSERT_LT(exact[5], 1e-9 * exact[6]);
  const modes::ModeSet set =
      modes::compute_modes(test::one_team(), made.mesh, made.body, *made.factor, {.count = 7});
  for (int k = 0; k < 6; ++k) EXPECT_EQ(set.angular_frequency[k], 0);
  EXPECT_NEAR(set.angular_frequency[6], std::sqrt(exact[6]), 1e-9 * std::sqrt(exact[6]));
}

TEST_P(FreeBody, has_the_eigenvalues_that_dense_algebra_finds) {
  const mesh::GmshSession gmsh;
  const Made made = make(geo(), 2);
  const Eigen::VectorXd exact = test::dense_eigenvalues(made.mesh, made.body);
  const double end = std::sqrt((exact[40] + exact[41]) / 2);
  if (exact[41] - exact[40] < 1e-6 * exact[40]) GTEST_SKIP() << "the cut falls on a double mode";
  const modes::ModeSet set = modes::compute_modes(test::one_team(), made.mesh, made.body, *made.factor,
                                                  {.up_to = to_hertz(RadPerSecond{end})});
  ASSERT_EQ(set.angular_frequency.size(), 41u);
  EXPECT_EQ(set.certificate.count_by_inertia, 41);
  EXPECT_TRUE(set.certificate.complete);
  for (int k = 6; k < 41; ++k)
    EXPECT_NEAR(set.angular_frequency[k], std::sqrt(exact[k]), 1e-9 * std::sqrt(exact[k])) << k;
  // K and M are diagonal in the modes. This is computed from the
  // matrices, not from the results of the solver.
  const Eigen::MatrixXd stiffness =
      modes::inner(made.mesh.comm, set.shape, test::product(made.body.stiffness, set.shape));
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(41, 41);
  for (int k = 0; k < 41; ++k) expected(k, k) = std::pow(set.angular_frequency[k], 2);
  EXPECT_LT((stiffness - expected).cwiseAbs().maxCoeff(), 1e-8 * exact[40]);
}

INSTANTIATE_TEST_SUITE_P(Elements, FreeBody, testing::Values("tet", "hex", "prism"));

TEST_P(FreeBody, has_the_same_modes_if_each_rank_computes_slices_of_its_own) {
  const mesh::GmshSession gmsh;
  const parallel::Teams& teams = test::own_teams();
  const Made made = make(geo(), 2, {}, teams);
  const Eigen::VectorXd exact = test::dense_eigenvalues(made.mesh, made.body);
  const modes::ModeSet set = modes::compute_modes(teams, made.mesh, made.body, *made.factor, {.count = 60});
  ASSERT_GE(set.angular_frequency.size(), 60u);
  EXPECT_EQ(parallel::sum(teams.peers(), static_cast<std::int64_t>(set.index.size())),
            static_cast<std::int64_t>(set.angular_frequency.size()));
  for (int k = 6; k < 60; ++k)
    EXPECT_NEAR(set.angular_frequency[k], std::sqrt(exact[k]), 1e-9 * std::sqrt(exact[k])) << k;
  // The shapes of each team belong to the frequencies that it reports.
  const Eigen::MatrixXd force = test::product(made.body.stiffness, set.shape),
                        inertia = test::product(made.body.mass, set.shape);
  for (Eigen::Index j = 0; j < set.shape.cols(); ++j) {
    const double lambda = std::pow(set.angular_frequency[static_cast<std::size_t>(set.index[j])], 2);
    EXPECT_LT((force.col(j) - lambda * inertia.col(j)).norm(), 2e-8 * std::max(force.col(j).norm(), 1e-3))
        << j;
  }
}

TEST(SupportedBody, keeps_the_rigid_motions_that_its_supports_leave_free) {
  const mesh::GmshSession gmsh;
  // A plane fixed along its normal permits two translations and one rotation.
  const Made made = make(test::block_geo("tet", 2, 0), 2, {{"bottom", "z"}});
  const modes::ModeSet set =
      modes::compute_modes(test::one_team(), made.mesh, made.body, *made.factor, {.count = 12});
  const Eigen::VectorXd exact = test::dense_eigenvalues(made.mesh, made.body);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(set.angular_frequency[k], 0);
  for (int k = 3; k < 12; ++k)
    EXPECT_NEAR(set.angular_frequency[k], std::sqrt(exact[k]), 1e-9 * std::sqrt(exact[k])) << k;
}

TEST(SeveralParts, have_the_rigid_modes_and_the_eigenvalues_of_each) {
  const mesh::GmshSession gmsh;
  // Two separate blocks, one of which is supported at its foot.
  const std::string two =
      "SetFactory(\"OpenCASCADE\");\nBox(1) = {0,0,0, 1,1,1};\nBox(2) = {3,0.5,0, 1,1.2,0.7};\nMeshSize{:} = "
      "0.7;\n"
      "Physical Volume(\"body\") = {1, 2};\nPhysical Surface(\"foot\") = {5};\n";
  for (const bool supported : {false, true}) {
    using Support = std::map<std::string, std::string>;
    const parallel::Teams* teams = supported ? &test::one_team() : &test::own_teams();
    const Made made = make(two, 2, supported ? Support{{"foot", "xyz"}} : Support{}, *teams);
    EXPECT_EQ(made.mesh.parts, 2);
    const Eigen::VectorXd exact = test::dense_eigenvalues(made.mesh, made.body);
    const modes::ModeSet set =
        modes::compute_modes(*teams, made.mesh, made.body, *made.factor, {.count = 40});
    const int rigid = supported ? 6 : 12;
    for (int k = 0; k < 40; ++k)
      if (k < rigid)
        EXPECT_EQ(set.angular_frequency[k], 0) << k;
      else
        EXPECT_NEAR(set.angular_frequency[k], std::sqrt(exact[k]), 1e-9 * std::sqrt(exact[k])) << k;
  }
}

TEST(SeveralParts, have_all_rigid_modes_if_fewer_are_wanted) {
  const mesh::GmshSession gmsh;
  const Made made = make(test::cubes_geo({{0, 0, 0}, {3, 0, 0}}, 1), 2);
  for (const modes::Solver solver : {modes::Solver::slicing, modes::Solver::dense})
    for (const std::int64_t count : {1, 2, 11, 12})
      EXPECT_EQ(modes::compute_modes(test::one_team(), made.mesh, made.body, *made.factor,
                                     {.count = count, .solver = solver})
                    .angular_frequency,
                std::vector<double>(12, 0))
          << count;
}

TEST(Hinge, has_rigid_modes_of_its_pieces_and_the_eigenvalues_of_both) {
  const mesh::GmshSession gmsh;
  for (const auto& [second, rigid] : {std::pair{std::array{1, 1, 0}, 7}, std::pair{std::array{1, 1, 1}, 9}}) {
    const Made made = make(test::cubes_geo({{0, 0, 0}, second}, 1), 2, {}, test::own_teams());
    const Eigen::VectorXd exact = test::dense_eigenvalues(made.mesh, made.body);
    const modes::ModeSet set =
        modes::compute_modes(test::own_teams(), made.mesh, made.body, *made.factor, {.count = 24});
    ASSERT_GE(set.angular_frequency.size(), 24U);
    for (int k = 0; k < 24; ++k)
      if (k < rigid)
        EXPECT_EQ(set.angular_frequency[k], 0) << k;
      else
        EXPECT_NEAR(set.angular_frequency[k], std::sqrt(exact[k]), 1e-9 * std::sqrt(exact[k])) << k;
  }
}

TEST(Count, that_would_split_a_double_mode_includes_it) {
  const mesh::GmshSession gmsh;
  // A square column of hexahedra has pairs of bending modes.
  const Made made = make(test::block_geo("hex", 2, 0), 2, {{"bottom", "xyz"}});
  const Eigen::VectorXd exact = test::dense_eigenvalues(made.mesh, made.body);
  Eigen::Index first = 0;
  while (exact[first + 1] - exact[first] > 1e-8 * exact[first]) ++first;
  const modes::ModeSet set =
      modes::compute_modes(test::one_team(), made.mesh, made.body, *made.factor, {.count = first + 1});
  EXPECT_EQ(static_cast<Eigen::Index>(set.angular_frequency.size()), first + 2);
  EXPECT_GT(set.cut, exact[first + 1]);
  EXPECT_LT(set.cut, exact[first + 2]);
}

TEST(Count, beyond_the_free_displacements_is_refused_on_every_rank) {
  const mesh::GmshSession gmsh;
  const Made rod = make(test::rod_geo(5), 1);
  EXPECT_THROW(modes::compute_modes(test::one_team(), rod.mesh, rod.body, *rod.factor, {.count = 7}),
               InputError);
}

// Far below the modes, round-off gives rigid motion an eigenvalue. Far above, K
// is negligible compared with the shift.
TEST(Band, that_ends_where_the_mesh_has_no_modes_is_refused_on_every_rank) {
  const mesh::GmshSession gmsh;
  const Made rod = make(test::rod_geo(5), 1);
  const double lowest = rod.body.wave_speed / 4;  // c/2L
  const auto modes_up_to = [&](double share) {
    const Hertz up_to{share * lowest};
    return modes::compute_modes(test::one_team(), rod.mesh, rod.body, *rod.factor, {.up_to = up_to})
        .angular_frequency.size();
  };
  for (const double share : {1e-30, 1e-10, 1e5, 1e20}) EXPECT_THROW(modes_up_to(share), InputError) << share;
  EXPECT_EQ(modes_up_to(1e-3), 1U);
  EXPECT_EQ(modes_up_to(1e3), 6U);
}

TEST(Band, that_ends_at_a_mode_includes_it) {
  const mesh::GmshSession gmsh;
  const parallel::Teams& teams = test::own_teams();
  const Made block = make(test::block_geo("tet", 2, 0), 2, {}, teams);
  const modes::ModeSet all =
      modes::compute_modes(teams, block.mesh, block.body, *block.factor, {.count = 30});
  for (const std::size_t n : {10U, 17U}) {
    const double omega = all.angular_frequency[n];
    const Hertz end = to_hertz(RadPerSecond{omega});
    const modes::ModeSet set =
        modes::compute_modes(teams, block.mesh, block.body, *block.factor, {.up_to = end});
    ASSERT_EQ(set.angular_frequency.size(), n + 1);
    EXPECT_NEAR(set.angular_frequency.back(), omega, 1e-9 * omega);
  }
}

/// Flexibility of all modes above the first `kept`, from the dense eigenvectors.
Eigen::MatrixXd dense_residual(const Made& made, const Eigen::MatrixXd& loads, Eigen::Index kept) {
  const Eigen::MatrixXd stiffness = test::dense(made.mesh, made.body, made.body.stiffness),
                        mass = test::dense(made.mesh, made.body, made.body.mass);
  const auto rows = test::free_rows(mass);
  const test::DenseModes modes(made.mesh.comm, stiffness(rows, rows), mass(rows, rows));
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(made.body.total_rows, loads.cols());
  whole.middleRows(made.mesh.first_node * made.mesh.components(), loads.rows()) = loads;
  parallel::sum(made.mesh.comm, whole);
  const Eigen::Index all = modes.value.size();
  const Eigen::MatrixXd trace = modes.vector.rightCols(all - kept).transpose() * whole(rows, Eigen::all);
  return trace.transpose() * modes.value.tail(all - kept).cwiseInverse().asDiagonal() * trace;
}

TEST(ResidualFlexibility, is_the_static_response_of_the_truncated_modes) {
  const mesh::GmshSession gmsh;
  for (const bool supported : {true, false}) {
    using Support = std::map<std::string, std::string>;
    const Made made =
        make(test::block_geo("tet", 2, 0.3), 2, supported ? Support{{"bottom", "xyz"}} : Support{});
    const modes::ModeSet set =
        modes::compute_modes(test::one_team(), made.mesh, made.body, *made.factor, {.count = 20});
    // Forces on a few nodes of several ranks, in each component. Fixed components are not loaded.
    Eigen::MatrixXd loads = Eigen::MatrixXd::Zero(made.body.local_rows, 3);
    for (std::size_t i = 0; i < made.mesh.node.size(); ++i) {
      const std::int64_t row = made.mesh.node[i] - made.mesh.first_node;
      if (row < 0 || row >= made.mesh.owned_nodes || made.mesh.position[3 * i + 2] < 0.5) continue;
      for (int k = 0; k < 3; ++k) loads(3 * row + k, k) = 1 + made.mesh.position[3 * i] + 0.1 * k;
    }
    const Eigen::MatrixXd exact =
        dense_residual(made, loads, static_cast<Eigen::Index>(set.angular_frequency.size()));
    const Eigen::MatrixXd ours = reduction::residual_response(test::one_team(), made.mesh, made.body,
                                                              *made.factor, set, loads.sparseView());
    // The modes are accurate to 1e-8, and the error of R is quadratic in theirs.
    EXPECT_LT((ours - exact).cwiseAbs().maxCoeff(), 1e-9 * exact.cwiseAbs().maxCoeff()) << supported;
  }
}

}  // namespace modes_test
}  // namespace ricochet
