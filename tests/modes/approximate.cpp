// SPDX-License-Identifier: BSD-2-Clause
// Approximate modes compared with dense eigenvalues, and the proof of their number.
#include "src/modes/approximate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "src/modes/residual.hpp"
#include "tests/meshes.hpp"
#include "tests/modes/dense.hpp"

namespace ricochet {
namespace approximate_test {

using Support = std::map<std::string, std::string>;

struct Made {
  scene::Body given;
  mesh::Mesh mesh;
  elasticity::Body body;
  std::unique_ptr<modes::Factorisation> factor;
};

Made make(const std::string& geo, int order, const Support& support = {},
          const parallel::Teams& teams = test::one_team()) {
  const test::SharedFile file(".geo", geo);
  Made made{test::body_of(file.path(), order), {}, {}, {}};
  made.given.support = support;
  made.mesh = test::mesh_of(made.given, teams);
  made.body = elasticity::assemble(made.mesh, made.given.materials, "test");
  made.factor = std::make_unique<modes::Factorisation>(made.body.stiffness, made.body.mass);
  return made;
}

modes::ModeSet approximate(const Made& made, const modes::ApproximateRequest& request,
                           const parallel::Teams& teams = test::one_team()) {
  return modes::approximate_modes(teams, made.mesh, made.body, *made.factor, made.given.materials, "test",
                                  request);
}

/// Largest relative error of the elastic frequencies, none of which may lie below the exact ones.
double worst_error(const modes::ModeSet& set, const Eigen::VectorXd& exact) {
  double worst = 0;
  for (std::size_t n = 0; n < set.angular_frequency.size(); ++n) {
    const double omega = set.angular_frequency[n];
    if (omega == 0) {
      EXPECT_LT(std::abs(exact[static_cast<Eigen::Index>(n)]), 1e-9 * exact[exact.size() - 1]) << n;
      continue;
    }
    const double error = omega / std::sqrt(exact[static_cast<Eigen::Index>(n)]) - 1;
    EXPECT_GT(error, -1e-9) << n;
    worst = std::max(worst, error);
  }
  return worst;
}

struct Case {
  const char* name;
  std::string geo;
  int order;
  Support support;
  std::int64_t count;
};

/// Two separate blocks, one of which is held at its foot.
std::string two_blocks() {
  return "SetFactory(\"OpenCASCADE\");\nBox(1) = {0,0,0, 1,1,1};\nBox(2) = {3,0.5,0, "
         "1,1.2,0.7};\nMeshSize{:} "
         "= 0.7;\nPhysical Volume(\"body\") = {1, 2};\nPhysical Surface(\"bottom\") = {5};\n";
}

class Approximate : public testing::TestWithParam<Case> {};

// Linear elements give starting frequencies that are tens of per cent too high.
TEST_P(Approximate, modes_are_bounds_from_above_that_iterations_bring_closer) {
  const mesh::GmshSession gmsh;
  const Case& given = GetParam();
  Eigen::VectorXd exact;
  for (const parallel::Teams* teams : {&test::one_team(), &test::own_teams()}) {
    const Made made = make(given.geo, given.order, given.support, *teams);
    if (exact.size() == 0) exact = test::dense_eigenvalues(made.mesh, made.body);
    double before = given.order == 2 ? 0.1 : 0.02;
    for (const int iterations : {1, 2}) {
      const modes::ModeSet set = approximate(made, {.count = given.count, .iterations = iterations}, *teams);
      ASSERT_GE(static_cast<std::int64_t>(set.angular_frequency.size()), given.count);
      EXPECT_TRUE(set.certificate.complete);
      EXPECT_GE(set.certificate.approximate, iterations);
      EXPECT_EQ(set.certificate.count_by_inertia, static_cast<std::int64_t>(set.angular_frequency.size()));
      const double error = worst_error(set, exact);
      EXPECT_LT(error, before) << iterations;
      // If the counts differ at first, the first set has already taken another iteration.
      before = std::max(1.001 * error, 1e-8);
    }
  }
}

// Impacts rely on both properties. They are computed from the matrices, not from the results of the solver.
TEST_P(Approximate, modes_are_orthogonal_in_mass_and_stiffness) {
  const mesh::GmshSession gmsh;
  const Case& given = GetParam();
  const Made made = make(given.geo, given.order, given.support);
  const modes::ModeSet set = approximate(made, {.count = given.count});
  const auto n = static_cast<Eigen::Index>(set.angular_frequency.size());
  Eigen::MatrixXd mass = modes::inner(made.mesh.comm, set.shape, test::product(made.body.mass, set.shape)),
                  stiffness =
                      modes::inner(made.mesh.comm, set.shape, test::product(made.body.stiffness, set.shape));
  ASSERT_EQ(mass.rows(), n);
  const double largest = stiffness.diagonal().maxCoeff();
  for (Eigen::Index k = 0; k < n; ++k)
    stiffness(k, k) -= std::pow(set.angular_frequency[static_cast<std::size_t>(k)], 2);
  mass -= Eigen::MatrixXd::Identity(n, n);
  EXPECT_LT(mass.cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_LT(stiffness.cwiseAbs().maxCoeff(), 1e-9 * largest);
}

INSTANTIATE_TEST_SUITE_P(
    Bodies, Approximate,
    testing::Values(Case{"free_tet_2", test::block_geo("tet", 2, 0.3), 2, {}, 15},
                    Case{"clamped_hex_2", test::block_geo("hex", 2, 0), 2, {{"bottom", "xyz"}}, 12},
                    Case{"free_hex_3", test::block_geo("hex", 2, 0), 3, {}, 30},
                    Case{"held_prism_3", test::prism_geo(2), 3, {{"bottom", "z"}}, 30},
                    Case{"two_parts_2", two_blocks(), 2, {{"bottom", "xyz"}}, 20},
                    Case{"rod_3", test::rod_geo(20), 3, {}, 12}),
    [](const auto& instance) { return std::string(instance.param.name); });

TEST(ApproximateModes, up_to_a_frequency_are_as_many_as_dense_algebra_finds) {
  const mesh::GmshSession gmsh;
  const Made made = make(test::block_geo("tet", 2, 0.3), 3);
  const Eigen::VectorXd exact = test::dense_eigenvalues(made.mesh, made.body);
  const Hertz end = to_hertz(RadPerSecond{std::sqrt((exact[40] + exact[41]) / 2)});
  const modes::ModeSet set = approximate(made, {.up_to = end, .iterations = 2});
  // The proved end is the first wide gap above the requested frequency.
  EXPECT_GE(set.certificate.upto_hz, end.value);
  const double proved = std::pow(static_cast<RadPerSecond>(Hertz{set.certificate.upto_hz}).value, 2);
  EXPECT_EQ(std::count_if(exact.begin(), exact.end(), [&](double lambda) { return lambda < proved; }),
            static_cast<std::ptrdiff_t>(set.angular_frequency.size()));
}

// The mesh is large enough for the lower order to start from the next lower order too.
TEST(ApproximateModes, from_two_orders_below_are_near_the_certified_ones) {
  const mesh::GmshSession gmsh;
  for (const parallel::Teams* teams : {&test::one_team(), &test::own_teams()}) {
    const Made made = make(test::block_geo("hex", 4, 0.3), 3, {{"bottom", "xyz"}}, *teams);
    const modes::ModeSet exact =
        modes::compute_modes(*teams, made.mesh, made.body, *made.factor, {.count = 31});
    const modes::ModeSet set = approximate(made, {.count = 30}, *teams);
    ASSERT_GE(set.angular_frequency.size(), 30u);
    for (std::size_t n = 0; n < 30; ++n) {
      const double error = set.angular_frequency[n] / exact.angular_frequency[n] - 1;
      EXPECT_GT(error, -1e-9) << n;
      EXPECT_LT(error, 1e-3) << n;
    }
  }
}

TEST(ApproximateModes, keep_a_double_mode_whole) {
  const mesh::GmshSession gmsh;
  const Made made = make(test::block_geo("hex", 2, 0), 3, {{"bottom", "xyz"}});
  const Eigen::VectorXd exact = test::dense_eigenvalues(made.mesh, made.body);
  Eigen::Index first = 0;
  while (exact[first + 1] - exact[first] > 1e-8 * exact[first]) ++first;
  const modes::ModeSet set = approximate(made, {.count = first + 1});
  EXPECT_EQ(static_cast<Eigen::Index>(set.angular_frequency.size()), first + 2);
}

TEST(ApproximateModes, and_their_static_correction_have_the_static_response_of_the_body) {
  const mesh::GmshSession gmsh;
  const Made made = make(test::block_geo("tet", 2, 0.3), 2, {{"bottom", "xyz"}});
  const modes::ModeSet set = approximate(made, {.count = 10});
  Eigen::MatrixXd loads = Eigen::MatrixXd::Zero(made.body.local_rows, 3);
  for (std::size_t i = 0; i < made.mesh.node.size(); ++i) {
    const std::int64_t row = made.mesh.node[i] - made.mesh.first_node;
    if (row < 0 || row >= made.mesh.owned_nodes || made.mesh.position[3 * i + 2] < 0.5) continue;
    for (int k = 0; k < 3; ++k) loads(3 * row + k, k) = 1 + made.mesh.position[3 * i] + 0.1 * k;
  }
  const Eigen::MatrixXd trace = modes::inner(made.mesh.comm, loads, set.shape);
  Eigen::VectorXd inverse(trace.cols());
  for (Eigen::Index k = 0; k < inverse.size(); ++k)
    inverse[k] = std::pow(set.angular_frequency[static_cast<std::size_t>(k)], -2);
  const Eigen::MatrixXd found = modes::residual_response(test::one_team(), made.mesh, made.body, *made.factor,
                                                         set, loads.sparseView()) +
                                trace * inverse.asDiagonal() * trace.transpose();

  const Eigen::MatrixXd stiffness = test::dense(made.mesh, made.body, made.body.stiffness);
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(made.body.total_rows, 3);
  whole.middleRows(made.mesh.first_node * 3, loads.rows()) = loads;
  parallel::sum(made.mesh.comm, whole);
  const Eigen::MatrixXd exact = whole.transpose() * stiffness.ldlt().solve(whole);
  // The residual flexibility makes up for the error of the vectors, which is about 1e-3.
  EXPECT_LT((found - exact).cwiseAbs().maxCoeff(), 1e-11 * exact.cwiseAbs().maxCoeff());
}

TEST(ApproximateModes, that_the_lower_order_cannot_provide_are_refused_on_every_rank) {
  const mesh::GmshSession gmsh;
  const Made rod = make(test::rod_geo(10), 2);
  EXPECT_THROW(approximate(rod, {.count = 8}), InputError);
  EXPECT_THROW(approximate(rod, {.up_to = Hertz{1e-3}}), InputError);
}

}  // namespace approximate_test
}  // namespace ricochet
