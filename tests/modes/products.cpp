// SPDX-License-Identifier: BSD-2-Clause
// Products with tall matrices and with K and M, against sums written out and PETSc's product of one column.
#include "src/modes/tall.hpp"

#include <gtest/gtest.h>

#include "src/modes/operators.hpp"
#include "tests/meshes.hpp"
#include "tests/modes/dense.hpp"

namespace ricochet {
namespace products_test {

using Eigen::Index;
using Eigen::MatrixXd;

// Numbers of rows, of columns of Q and of columns of Y, around those that are treated at once.
struct Size {
  Index rows, basis, columns;
};

class Tall : public testing::TestWithParam<Size> {};

INSTANTIATE_TEST_SUITE_P(Sizes, Tall,
                         testing::Values(Size{1, 1, 1}, Size{7, 5, 3}, Size{513, 12, 16}, Size{520, 13, 17},
                                         Size{1300, 37, 8}, Size{700, 25, 33}, Size{600, 0, 4},
                                         Size{0, 3, 2}),
                         [](const auto& size) {
                           return std::to_string(size.param.rows) + "x" + std::to_string(size.param.basis) +
                                  "x" + std::to_string(size.param.columns);
                         });

// Sums of 1300 products of numbers below 1 differ by less than 1300² ε/4.
constexpr double tolerance = 1e-10;

TEST_P(Tall, inner_is_the_sum_of_products) {
  const auto [rows, basis, columns] = GetParam();
  // Rows of a larger matrix, so that columns are not contiguous.
  const MatrixXd q = MatrixXd::Random(rows + 5, basis), y = MatrixXd::Random(rows + 3, columns);
  for (const modes::TallLoops& loops : modes::tall_loops()) {
    const MatrixXd product = modes::tall_inner(q.topRows(rows), y.topRows(rows), loops);
    ASSERT_EQ(product.rows(), basis);
    ASSERT_EQ(product.cols(), columns);
    for (Index k = 0; k < basis; ++k)
      for (Index j = 0; j < columns; ++j) {
        long double sum = 0;
        for (Index i = 0; i < rows; ++i) sum += static_cast<long double>(q(i, k)) * y(i, j);
        EXPECT_NEAR(product(k, j), static_cast<double>(sum), tolerance) << k << ", " << j;
      }
  }
}

TEST_P(Tall, subtract_changes_its_rows_alone) {
  const auto [rows, basis, columns] = GetParam();
  const MatrixXd q = MatrixXd::Random(rows + 5, basis), c = MatrixXd::Random(basis, columns),
                 before = MatrixXd::Random(rows + 3, columns + 2);
  for (const modes::TallLoops& loops : modes::tall_loops()) {
    MatrixXd y = before;
    modes::tall_subtract(q.topRows(rows), c, y.block(1, 1, rows, columns), loops);
    for (Index i = 0; i < y.rows(); ++i)
      for (Index j = 0; j < y.cols(); ++j) {
        long double value = before(i, j);
        if (i >= 1 && i <= rows && j >= 1 && j <= columns)
          for (Index k = 0; k < basis; ++k) value -= static_cast<long double>(q(i - 1, k)) * c(k, j - 1);
        EXPECT_NEAR(y(i, j), static_cast<double>(value), tolerance) << i << ", " << j;
      }
  }
}

TEST(Product, of_many_columns_is_that_of_each) {
  for (const char* kind : {"tet", "hex"}) {
    const test::SharedFile file(".geo", test::block_geo(kind, 3, 0.4));
    const mesh::GmshSession gmsh;
    const scene::Body given = test::body_of(file.path(), 2);
    const mesh::Mesh mesh = test::mesh_of(given);
    const elasticity::Body body = elasticity::assemble(mesh, given.materials, "test");
    const modes::Operators operators(mesh, body);
    for (const Index columns : {1, 8, 11}) {
      const MatrixXd x = operators.noise(columns, 3);
      for (const auto& [product, matrix] : {std::pair(&operators.stiffness, static_cast<Mat>(body.stiffness)),
                                            std::pair(&operators.mass, static_cast<Mat>(body.mass))}) {
        const MatrixXd expected = test::product(matrix, x);
        const double scale = parallel::largest(mesh.comm, test::largest_entry(expected));
        // Some hundred entries a row, each rounded.
        EXPECT_LT(parallel::largest(mesh.comm, test::largest_entry((*product)(x)-expected)), 1e-13 * scale)
            << kind << ", " << columns << " columns";
      }
    }
  }
}

}  // namespace products_test
}  // namespace ricochet
