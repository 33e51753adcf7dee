// SPDX-License-Identifier: BSD-2-Clause
// Static flexibilities and residual flexibilities compared with dense sums over the modes of the body.
#include "src/reduction/static_flexibility.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "src/elasticity/rigid.hpp"
#include "src/reduction/residual.hpp"
#include "tests/meshes.hpp"
#include "tests/modes/dense.hpp"

namespace ricochet {
namespace static_flexibility_test {

using Eigen::MatrixXd;
using Supports = std::map<std::string, std::string>;

/// A beam of length 48 and unit cross-section along z. Its first bending mode is 10⁵ times as flexible as its
/// surface under a hat.
std::string beam_geo() {
  return "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 1, 1, 48};\nMeshSize{:} = 4;\n"
         "Transfinite Curve{:} = 2;\nTransfinite Curve{1, 3, 5, 7} = 17;\nTransfinite Surface{:};\n"
         "Recombine Surface{:};\nTransfinite Volume{1};\nPhysical Volume(\"body\") = {1};\n"
         "Physical Surface(\"bottom\") = {5};\nPhysical Surface(\"top\") = {6};\n";
}

/// A body in teams, with forces on a few nodes in each component.
struct Loaded {
  Loaded(const parallel::Teams& given, const std::string& geo, int order, const Supports& support)
      : teams(given) {
    const test::SharedFile file(".geo", geo);
    scene::Body asked = test::body_of(file.path(), order);
    asked.support = support;
    mesh = test::mesh_of(asked, teams);
    body = elasticity::assemble(mesh, asked.materials, "test");
    factor = std::make_unique<modes::Factorisation>(body.stiffness, body.mass);
    MatrixXd forces = MatrixXd::Zero(body.local_rows, 6);
    for (std::size_t i = 0; i < mesh.node.size(); ++i) {
      const std::int64_t row = mesh.node[i] - mesh.first_node;
      if (row < 0 || row >= mesh.owned_nodes) continue;
      const double x = mesh.position[3 * i], z = mesh.position[3 * i + 2];
      if (z > 0.5 && z < 1.5)
        for (int k = 0; k < 3; ++k) forces(3 * row + k, k) = 1 + x + 0.1 * k;
      if (z > 0.9 && x > 0.4)
        for (int k = 0; k < 3; ++k) forces(3 * row + k, 3 + k) = 0.1;
    }
    loads = forces.sparseView();
    whole = MatrixXd::Zero(body.total_rows, forces.cols());
    whole.middleRows(mesh.first_node * 3, forces.rows()) = forces;
    parallel::sum(mesh.comm, whole);
    stiffness = test::dense(mesh, body, body.stiffness);
    mass = test::dense(mesh, body, body.mass);
  }

  /// Σ B B ᵀ/λ of all modes after the first `kept`. A sum of positive terms, without cancellation.
  MatrixXd truncated(Eigen::Index kept) const {
    const auto rows = test::free_rows(mass);
    const test::DenseModes all(PETSC_COMM_WORLD, stiffness(rows, rows), mass(rows, rows));
    const Eigen::Index rest = all.value.size() - kept;
    const MatrixXd trace = all.vector.rightCols(rest).transpose() * whole(rows, Eigen::all);
    return trace.transpose() * all.value.tail(rest).cwiseInverse().asDiagonal() * trace;
  }

  std::vector<std::int64_t> on_springs() const {
    return reduction::determinate_rows(mesh.comm, elasticity::rigid_modes(mesh, body),
                                       factor->entries().first);
  }

  const parallel::Teams& teams;
  mesh::Mesh mesh;
  elasticity::Body body;
  std::unique_ptr<modes::Factorisation> factor;
  reduction::Loads loads;
  MatrixXd whole, stiffness, mass;
};

double difference(const MatrixXd& found, const MatrixXd& exact) {
  return (found - exact).cwiseAbs().maxCoeff() / exact.cwiseAbs().maxCoeff();
}

class StaticFlexibility : public testing::TestWithParam<bool> {
 protected:
  const parallel::Teams& teams() const { return GetParam() ? test::own_teams() : test::one_team(); }
  const mesh::GmshSession gmsh_;
};
INSTANTIATE_TEST_SUITE_P(Teams, StaticFlexibility, testing::Bool(), [](const auto& teams) {
  return std::string(teams.param ? "rank_for_itself" : "ranks_together");
});

TEST_P(StaticFlexibility, of_a_body_on_springs_is_that_of_the_dense_matrix) {
  // Supports that leave all, two and no rigid motions free.
  for (const Supports& support : {Supports{}, {{"bottom", "z"}, {"top", "x"}}, {{"bottom", "xyz"}}}) {
    Loaded made(teams(), test::block_geo("hex", 2, 0.2), 1, support);
    const std::vector<std::int64_t> on_springs = made.on_springs();
    MatrixXd supported = made.stiffness;
    for (const std::int64_t row : on_springs) supported(row, row) *= 2;
    const MatrixXd exact = made.whole.transpose() * supported.llt().solve(made.whole);
    reduction::BorderedStiffness bordered(made.teams, *made.factor, on_springs, made.loads);
    EXPECT_GT(parallel::largest(PETSC_COMM_WORLD, bordered.expected_mib()), 0);
    const MatrixXd found = bordered.flexibility();
    if (parallel::rank_of(PETSC_COMM_WORLD) != 0) {
      EXPECT_EQ(found.size(), 0);
      continue;
    }
    EXPECT_LT(difference(found, exact), 1e-12);  // round-off times the condition, about 1e3
    EXPECT_EQ((found - found.transpose()).cwiseAbs().maxCoeff(), 0);
  }
}

TEST_P(StaticFlexibility, needs_one_spring_for_each_rigid_motion_and_loads_none_of_them) {
  Loaded made(teams(), test::block_geo("hex", 2, 0.2), 1, {});
  const std::vector<std::int64_t> on_springs = made.on_springs();
  ASSERT_EQ(on_springs.size(), 6U);
  MatrixXd supported = made.stiffness;
  for (const std::int64_t row : on_springs) supported(row, row) *= 2;
  // Loads in equilibrium, K times anything, move no spring.
  const MatrixXd moved = supported.llt().solve(made.stiffness * made.whole);
  for (const std::int64_t row : on_springs)
    EXPECT_LT(moved.row(row).cwiseAbs().maxCoeff(), 1e-12 * moved.cwiseAbs().maxCoeff());
}

TEST_P(StaticFlexibility, beyond_the_modes_of_a_slender_beam_keeps_its_digits) {
  for (const bool clamped : {false, true}) {
    Loaded made(teams(), beam_geo(), 2, clamped ? Supports{{"bottom", "xyz"}} : Supports{});
    const modes::ModeSet set =
        modes::compute_modes(made.teams, made.mesh, made.body, *made.factor, {.count = 24});
    const auto kept = static_cast<Eigen::Index>(set.angular_frequency.size());
    const MatrixXd found =
        reduction::residual_response(made.teams, made.mesh, made.body, *made.factor, set, made.loads);
    // Subtracting the first modes instead of projecting them out would leave an error of 4e-3.
    const MatrixXd exact = made.truncated(kept);
    EXPECT_LT(difference(found, exact), 1e-8) << clamped;
    reduction::ResidualColumns columns(made.teams, made.mesh, made.body, *made.factor, set, made.loads);
    for (const std::vector<Eigen::Index>& some : {std::vector<Eigen::Index>{5, 0, 2}, {3}})
      EXPECT_LT((columns.at(some) - exact(Eigen::all, some)).cwiseAbs().maxCoeff(),
                1e-8 * exact.cwiseAbs().maxCoeff())
          << clamped;
  }
}

TEST_P(StaticFlexibility, leaves_the_matrices_ready_for_other_shifts) {
  Loaded made(teams(), test::block_geo("hex", 2, 0.2), 1, {});
  made.factor->factor(-1.0);
  made.factor->release();
  made.factor->factor_on_springs(made.on_springs());
  const MatrixXd x = made.factor->solve(MatrixXd(made.loads));
  const MatrixXd flexibility = modes::inner(made.mesh.comm, made.loads, x);
  const MatrixXd found =
      reduction::BorderedStiffness(made.teams, *made.factor, made.on_springs(), made.loads).flexibility();
  if (found.size() > 0) {
    EXPECT_LT(difference(found, flexibility), 1e-12);
  }
  made.factor->factor(-1.0);
  EXPECT_EQ(made.factor->below(), 0);
}

}  // namespace static_flexibility_test
}  // namespace ricochet
