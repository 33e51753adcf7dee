// SPDX-License-Identifier: BSD-2-Clause
// Start vectors of a search for modes, and the signs of modes, on any number of ranks.
#include "src/modes/operators.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "src/modes/certify.hpp"
#include "src/modes/lanczos.hpp"
#include "tests/meshes.hpp"
#include "tests/modes/dense.hpp"

namespace ricochet {
namespace operators_test {

using Eigen::Index;
using Eigen::MatrixXd;

/// A block on all ranks, and one that each rank has alone.
struct Blocks {
  Blocks() {
    const test::SharedFile file(".geo", test::block_geo("tet", 2, 0.3));
    const scene::Body given = test::body_of(file.path(), 2);
    mesh = test::mesh_of(given);
    body = elasticity::assemble(mesh, given.materials, "test");
    alone = test::mesh_of(given, test::own_teams());
    body_alone = elasticity::assemble(alone, given.materials, "test");
  }
  mesh::GmshSession gmsh;
  mesh::Mesh mesh, alone;
  elasticity::Body body, body_alone;
};

/// Rows of all ranks in reading order.
MatrixXd in_order(const modes::Operators& operators, const MatrixXd& local) {
  MatrixXd all = MatrixXd::Zero(operators.total_rows, local.cols());
  for (Index i = 0; i < local.rows(); ++i) all.row(operators.key[static_cast<std::size_t>(i)]) = local.row(i);
  parallel::sum(operators.comm, all);
  return all;
}

TEST(Noise, is_the_same_on_any_ranks_and_uncorrelated) {
  const Blocks blocks;
  const modes::Operators operators(blocks.mesh, blocks.body), alone(blocks.alone, blocks.body_alone);
  const MatrixXd noise = in_order(operators, operators.noise(40, 3));
  EXPECT_EQ(noise, in_order(alone, alone.noise(40, 3)));
  EXPECT_LE(noise.maxCoeff(), 1);
  EXPECT_GE(noise.minCoeff(), -1);
  // The next seed gives the next columns.
  EXPECT_EQ(noise.rightCols(33), in_order(operators, operators.noise(33, 10)));
  // Means and products of n numbers that are even in [−1, 1] scatter by √(1/3n) and 1/(3√n).
  const auto n = static_cast<double>(noise.rows());
  EXPECT_LT(test::largest_entry(noise.colwise().mean()), 5 * std::sqrt(1 / (3 * n)));
  const MatrixXd gram = noise.transpose() * noise / n - MatrixXd::Identity(40, 40) / 3;
  EXPECT_LT(test::largest_entry(gram), 5 / (3 * std::sqrt(n)));
}

// Column j has seed + j, so a search whose seed advances by less than its columns repeats some of them.
TEST(OtherStart, shares_no_vector_with_any_earlier_one) {
  const Blocks blocks;
  const modes::Operators operators(blocks.mesh, blocks.body);
  modes::LanczosOptions options{.tolerance = 1e-5, .basis = 700};
  MatrixXd all(operators.local_rows, 0);
  for (const Index width : {16, 32, 64, 128, 256, 256}) {
    ASSERT_EQ(options.block, width);
    EXPECT_EQ(options.tolerance, 1e-5);
    EXPECT_EQ(options.basis, 700);
    all.conservativeResize(Eigen::NoChange, all.cols() + width);
    all.rightCols(width) = operators.noise(width, options.seed);
    options = modes::other_start(options);
  }
  MatrixXd gram = all.transpose() * all;
  parallel::sum(operators.comm, gram);
  const Eigen::VectorXd size = gram.diagonal().cwiseSqrt();
  gram = size.cwiseInverse().asDiagonal() * gram * size.cwiseInverse().asDiagonal();
  gram.diagonal().setZero();
  // Cosines of uncorrelated vectors scatter by 1/√n. That of a vector with itself is 1.
  EXPECT_LT(test::largest_entry(gram), 7 / std::sqrt(static_cast<double>(operators.total_rows)));
}

TEST(FixSigns, makes_the_largest_entry_of_each_mode_positive_on_any_ranks) {
  const Blocks blocks;
  const modes::Operators operators(blocks.mesh, blocks.body);
  MatrixXd shape = operators.noise(9, 5);
  // In the middle column, two entries of opposite signs are the largest, up to round-off. The first one in
  // reading order decides.
  for (Index i = 0; i < shape.rows(); ++i) {
    const std::int64_t key = operators.key[static_cast<std::size_t>(i)];
    if (key == 20) shape(i, 4) = -2;
    if (key == operators.total_rows - 3) shape(i, 4) = 2 + 1e-12;
  }
  const MatrixXd before = in_order(operators, shape);
  MatrixXd opposite = -shape;
  modes::fix_signs(operators, shape);
  modes::fix_signs(operators, opposite);
  EXPECT_EQ(shape, opposite);
  const MatrixXd after = in_order(operators, shape);
  for (Index j = 0; j < 9; ++j) {
    const double top = before.col(j).cwiseAbs().maxCoeff();
    Index first = 0;
    while (std::abs(before(first, j)) < 0.999 * top) ++first;
    EXPECT_EQ(after.col(j), (before(first, j) < 0 ? -1 : 1) * before.col(j)) << j;
  }
  EXPECT_LT(before(20, 4) * after(20, 4), 0);
}

}  // namespace operators_test
}  // namespace ricochet
