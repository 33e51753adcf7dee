// SPDX-License-Identifier: BSD-2-Clause
// The factorisation compared with its definition, (K − σM) x = b, and
// with eigenvalue counts from dense LAPACK.
#include "src/modes/factorisation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "src/modes/operators.hpp"
#include "tests/meshes.hpp"
#include "tests/modes/dense.hpp"

namespace ricochet {
namespace factorisation_test {

TEST(Factorisation, solves_the_shifted_problem) {
  const test::SharedFile file(".geo", test::block_geo("tet", 2, 0.4));
  const mesh::GmshSession gmsh;
  scene::Body given = test::body_of(file.path(), 2);
  given.support = {{"bottom", "xyz"}, {"top", "x"}};
  const mesh::Mesh mesh = test::mesh_of(given);
  const elasticity::Body body = elasticity::assemble(mesh, given.materials, "test");
  const double sigma = 3.0;
  modes::Factorisation factor(body.stiffness, body.mass);
  factor.factor(sigma);
  Eigen::MatrixXd right(body.local_rows, 4);
  for (Eigen::Index i = 0; i < right.rows(); ++i)
    for (Eigen::Index j = 0; j < right.cols(); ++j)
      right(i, j) =
          std::sin(1.0 + static_cast<double>(3 * mesh.first_node + i) * (1.7 + static_cast<double>(j)));
  const Eigen::MatrixXd x = factor.solve(right);
  const Eigen::MatrixXd defect =
      test::product(body.stiffness, x) - sigma * test::product(body.mass, x) - right;
  // The condition number is about 1e4, and the entries are of order one.
  EXPECT_LT(parallel::largest(mesh.comm, test::largest_entry(defect)), 1e-11);
}

TEST(Factorisation, counts_the_eigenvalues_below_each_shift_as_lapack_does) {
  for (const bool supported : {false, true}) {
    const test::SharedFile file(".geo", test::block_geo("tet", 2, 0.4));
    const mesh::GmshSession gmsh;
    scene::Body given = test::body_of(file.path(), 2);
    if (supported) given.support = {{"bottom", "xyz"}};
    const mesh::Mesh mesh = test::mesh_of(given);
    const elasticity::Body body = elasticity::assemble(mesh, given.materials, "test");
    const Eigen::VectorXd exact = test::dense_eigenvalues(mesh, body);
    modes::Factorisation factor(body.stiffness, body.mass);
    for (const double fraction : {0.02, 0.2, 0.5}) {
      const auto at = static_cast<Eigen::Index>(fraction * static_cast<double>(exact.size()));
      Eigen::Index k = at;
      while (exact[k + 1] - exact[k] < 1e-3 * exact[k]) ++k;
      const double sigma = (exact[k] + exact[k + 1]) / 2;
      factor.factor(sigma);
      EXPECT_EQ(factor.below(), k + 1) << "shift " << sigma;
    }
    factor.factor(-1.0);
    EXPECT_EQ(factor.below(), 0);
  }
}

TEST(Factorisation, in_low_rank_solves_to_about_its_threshold) {
  const test::SharedFile file(".geo", test::block_geo("hex", 9, 0.4));
  const mesh::GmshSession gmsh;
  scene::Body given = test::body_of(file.path(), 2);
  const mesh::Mesh mesh = test::mesh_of(given);
  const elasticity::Body body = elasticity::assemble(mesh, given.materials, "test");
  const modes::Operators operators(mesh, body);
  const Eigen::MatrixXd right = operators.noise(4, 1);
  std::vector<double> error;
  for (const double threshold : {0.0, 1e-4}) {
    modes::Factorisation factor(body.stiffness, body.mass, threshold);
    factor.factor(-1.0);
    const Eigen::MatrixXd x = factor.solve(right);
    const Eigen::MatrixXd defect = test::product(body.stiffness, x) + test::product(body.mass, x) - right;
    error.push_back(parallel::largest(mesh.comm, test::largest_entry(defect)));
  }
  // The norm of the factors is about 1e3. A smaller block has no front that is large enough to be compressed,
  // and would leave round-off in both.
  EXPECT_LT(error[0], 1e-10);
  EXPECT_GT(error[1], 1e-4);
  EXPECT_LT(error[1], 1);
}

}  // namespace factorisation_test
}  // namespace ricochet
