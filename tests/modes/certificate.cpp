// SPDX-License-Identifier: BSD-2-Clause
// The certificate of a mode set: what it states about a good one, each way in which a set can be wrong, and
// the repair of modes that are not accurate enough.
#include "src/modes/certify.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>

#include "src/modes/repair.hpp"
#include "tests/meshes.hpp"
#include "tests/modes/dense.hpp"

namespace ricochet {
namespace certificate_test {

using modes::ModeSet;
using modes::Probe;
using modes::Solver;

constexpr double tolerance = 1e-8;

/// A free block with some modes, on one team or on several. From 60 on, each team has slices of its own.
struct Block {
  explicit Block(const parallel::Teams& given, Solver solver = Solver::slicing, std::int64_t count = 30)
      : teams(given) {
    const test::SharedFile file(".geo", test::block_geo("tet", 2, 0.3));
    const scene::Body body_of_scene = test::body_of(file.path(), 2);
    mesh = test::mesh_of(body_of_scene, teams);
    body = elasticity::assemble(mesh, body_of_scene.materials, "test");
    factor = std::make_unique<modes::Factorisation>(body.stiffness, body.mass);
    set = modes::compute_modes(teams, mesh, body, *factor, {.count = count, .solver = solver});
    operators = std::make_unique<modes::Operators>(mesh, body);
    for (std::size_t s = 0; s < set.certificate.shift.size(); ++s)
      counts.push_back({set.certificate.shift[s], static_cast<std::int64_t>(set.certificate.modes_below[s])});
  }
  std::vector<Eigen::Index> certify() { return modes::certify(teams, *operators, counts, tolerance, set); }
  /// This team's column of a mode, or none.
  std::optional<Eigen::Index> column(Eigen::Index mode) const {
    const auto at = std::ranges::find(set.index, mode);
    return at == set.index.end() ? std::nullopt : std::optional(at - set.index.begin());
  }
  const parallel::Teams& teams;
  mesh::Mesh mesh;
  elasticity::Body body;
  std::unique_ptr<modes::Factorisation> factor;
  std::unique_ptr<modes::Operators> operators;
  ModeSet set;
  std::vector<Probe> counts;
};

class Certificate : public testing::TestWithParam<bool> {
 protected:
  const parallel::Teams& teams() const { return GetParam() ? test::own_teams() : test::one_team(); }
  const mesh::GmshSession gmsh;
};

INSTANTIATE_TEST_SUITE_P(OnTeams, Certificate, testing::Bool());

TEST_P(Certificate, has_the_counts_of_dense_eigenvalues_at_its_shifts) {
  Block block(teams());
  const Eigen::VectorXd exact = test::dense_eigenvalues(block.mesh, block.body);
  const kernels::Certificate& certificate = block.set.certificate;
  ASSERT_GE(certificate.shift.size(), 2U);  // of a slice, and at the end
  for (std::size_t s = 0; s < certificate.shift.size(); ++s)
    EXPECT_EQ(certificate.modes_below[s], (exact.array() < certificate.shift[s]).count()) << s;
  EXPECT_EQ(certificate.shift.back(), block.set.cut);
  EXPECT_TRUE(certificate.complete);
  EXPECT_TRUE(block.certify().empty());
}

/// A way in which a set can be wrong, and the modes that the certificate then doubts.
struct Sabotage {
  std::string name;
  std::function<void(Block&)> apply;
  std::vector<Eigen::Index> doubtful;
};

void change_column(Block& block, Eigen::Index mode,
                   const std::function<Eigen::VectorXd(Eigen::VectorXd)>& to) {
  if (const auto j = block.column(mode)) block.set.shape.col(*j) = to(block.set.shape.col(*j));
}

const std::vector<Sabotage> sabotages{
    {"a mode is lost",
     [](Block& block) {
       const auto j = block.column(20);
       block.set.angular_frequency.erase(block.set.angular_frequency.begin() + 20);
       if (j) {
         Eigen::MatrixXd rest(block.set.shape.rows(), block.set.shape.cols() - 1);
         rest << block.set.shape.leftCols(*j), block.set.shape.rightCols(rest.cols() - *j);
         block.set.shape = rest;
         block.set.index.erase(block.set.index.begin() + *j);
       }
       for (Eigen::Index& n : block.set.index) n -= n > 20;
     },
     {}},
    {"a shape has an error of 1e-6",
     [](Block& block) {
       const Eigen::VectorXd noise = block.operators->noise(1, 7);
       change_column(block, 12, [&](const Eigen::VectorXd& shape) {
         const double size = block.operators->norms(shape)[0] / block.operators->norms(noise)[0];
         return Eigen::VectorXd(shape + 1e-6 * size * noise);
       });
     },
     {12}},
    {"a frequency is wrong by 1e-7", [](Block& block) { block.set.angular_frequency[15] *= 1 + 1e-7; }, {15}},
    {"a shape is too long by 1e-5",
     [](Block& block) {
       change_column(block, 9, [](const Eigen::VectorXd& shape) { return Eigen::VectorXd(1.00001 * shape); });
     },
     {9}},
    {"a shape is not a number",
     [](Block& block) {
       change_column(block, 18, [](Eigen::VectorXd shape) {
         if (shape.size() > 0) shape[0] = std::nan("");
         return shape;
       });
     },
     // Its product with any other mode is not a number either.
     {}},
    {"an inertia count is one more", [](Block& block) { ++block.counts.front().below; }, {}},
    {"the last inertia count is one less", [](Block& block) { --block.counts.back().below; }, {}},
    {"there is no inertia count", [](Block& block) { block.counts.clear(); }, {}},
    {"the last count is not at the end",
     [](Block& block) {
       block.counts = {
           {std::pow((block.set.angular_frequency[10] + block.set.angular_frequency[11]) / 2, 2), 11}};
     },
     {}},
};

TEST_P(Certificate, is_incomplete_for_every_sabotage) {
  Block block(teams());
  const ModeSet set = block.set;
  const std::vector<Probe> counts = block.counts;
  for (const Sabotage& sabotage : sabotages) {
    block.set = set;
    block.counts = counts;
    sabotage.apply(block);
    const std::vector<Eigen::Index> doubtful = block.certify();
    EXPECT_FALSE(block.set.certificate.complete) << sabotage.name;
    if (!sabotage.doubtful.empty()) {
      EXPECT_EQ(doubtful, sabotage.doubtful) << sabotage.name;
    }
    EXPECT_THROW(modes::refuse_incomplete(block.set, doubtful), SolverError) << sabotage.name;
  }
}

// Both copies of a mode, and the other one is missing.
TEST_P(Certificate, doubts_modes_that_are_one) {
  Block block(teams());
  const auto from = block.column(13), to = block.column(14);
  if (GetParam() && block.teams.count() > 1) GTEST_SKIP() << "the modes may belong to two teams";
  block.set.shape.col(*to) = block.set.shape.col(*from);
  block.set.angular_frequency[14] = block.set.angular_frequency[13];
  EXPECT_EQ(block.certify(), (std::vector<Eigen::Index>{13, 14}));
  EXPECT_NEAR(block.set.certificate.orthonormality, 1, 1e-6);
}

// After a repair, only the modes that it has changed are measured.
TEST_P(Certificate, states_the_same_if_only_the_changed_mode_is_measured) {
  Block block(teams(), Solver::slicing, 80);
  const auto from = block.column(13), to = block.column(70);
  Eigen::MatrixXd shape = Eigen::MatrixXd::Zero(block.operators->local_rows, 1);
  if (from) shape = block.set.shape.col(*from);
  parallel::sum(block.teams.peers(), shape);
  if (to) block.set.shape.col(*to) = shape;
  const std::vector<Eigen::Index> doubtful = modes::certify(
      block.teams, *block.operators, block.counts, tolerance, block.set, std::vector<Eigen::Index>{70});
  EXPECT_EQ(doubtful, (std::vector<Eigen::Index>{13, 70}));
  // K φ = λ₁₃ M φ, so the residual is λ₇₀/λ₁₃ − 1.
  const double ratio = block.set.angular_frequency[70] / block.set.angular_frequency[13];
  EXPECT_NEAR(block.set.residual[70], ratio * ratio - 1, 1e-6);
  const ModeSet partial = block.set;
  EXPECT_EQ(block.certify(), doubtful);
  for (std::size_t n = 0; n < partial.residual.size(); ++n) {
    // Round-off of products in another order; overlaps of accurate modes are round-off themselves.
    EXPECT_NEAR(partial.residual[n], block.set.residual[n], 1e-6 * block.set.residual[n] + 1e-12) << n;
    EXPECT_NEAR(partial.overlap[n], block.set.overlap[n], 1e-8) << n;
  }
}

// Errors of 1e-3 in the lowest elastic mode and in two neighbours. The dense eigenvalues are the oracle.
TEST_P(Certificate, is_complete_after_inaccurate_modes_are_repaired) {
  Block block(teams());
  const Eigen::VectorXd exact = test::dense_eigenvalues(block.mesh, block.body);
  const std::vector<Eigen::Index> bad{6, 17, 18};
  for (const Eigen::Index mode : bad) {
    const Eigen::VectorXd noise = block.operators->noise(1, static_cast<std::uint64_t>(mode));
    change_column(block, mode, [&](const Eigen::VectorXd& shape) {
      const double size = block.operators->norms(shape)[0] / block.operators->norms(noise)[0];
      return Eigen::VectorXd(shape + 1e-3 * size * noise);
    });
    block.set.angular_frequency[static_cast<std::size_t>(mode)] *= 1 + 1e-4;
  }
  std::vector<Eigen::Index> doubtful = block.certify();
  for (const Eigen::Index mode : bad) EXPECT_TRUE(std::ranges::count(doubtful, mode)) << mode;
  modes::repair(block.teams, *block.operators, *block.factor, doubtful, block.set);
  EXPECT_TRUE(block.certify().empty());
  EXPECT_TRUE(block.set.certificate.complete);
  for (int k = 6; k < 30; ++k)
    EXPECT_NEAR(block.set.angular_frequency[static_cast<std::size_t>(k)], std::sqrt(exact[k]),
                1e-9 * std::sqrt(exact[k]))
        << k;
}

/// Modes of a rod by one of the solvers.
ModeSet of_rod(const parallel::Teams& teams, int elements, int order, std::int64_t count, Solver solver) {
  const test::SharedFile file(".geo", test::rod_geo(elements));
  const scene::Body given = test::body_of(file.path(), order);
  const mesh::Mesh mesh = test::mesh_of(given, teams);
  const elasticity::Body body = elasticity::assemble(mesh, given.materials, "test");
  modes::Factorisation factor(body.stiffness, body.mass);
  return modes::compute_modes(teams, mesh, body, factor, {.count = count, .solver = solver});
}

/// Dispersion relation of linear elements of length h with consistent mass: ω of wave number κ.
double discrete_omega(double kappa, double h, double young, double density) {
  const double c = std::cos(kappa * h);
  return std::sqrt(6 * young / (density * h * h) * (1 - c) / (2 + c));
}

// More than half of all modes: the Lanczos basis reaches the end of the space and stalls. The round-off of λ
// is that of the largest eigenvalue, 1e5 times the smallest.
TEST_P(Certificate, is_complete_for_rods_of_which_most_modes_are_wanted) {
  constexpr int n = 500;
  for (const Solver solver : {Solver::slicing, Solver::dense, Solver::fastest}) {
    const ModeSet set = of_rod(teams(), n, 1, 293, solver);
    EXPECT_TRUE(set.certificate.complete);
    for (int k = 1; k < 293; ++k)
      ASSERT_NEAR(set.angular_frequency[static_cast<std::size_t>(k)] /
                      discrete_omega(k * std::numbers::pi / 2, 2.0 / n, 3.0, 2.0),
                  1, 1e-9)
          << k;
  }
}

}  // namespace certificate_test
}  // namespace ricochet
