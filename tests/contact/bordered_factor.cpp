// SPDX-License-Identifier: BSD-2-Clause
// A factor with a border against a factor of the whole matrix, made by Eigen.
#include <gtest/gtest.h>

#include <array>
#include <random>
#include <vector>

#include "contact/complementarity/bordered_factor.hpp"

namespace ricochet::contact {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int n = 70, b = 9;

// Of sizes that leave remainders of all registers, against products by Eigen. 1e-13: sums of at most 21
// terms.
TEST(DenseLoops, give_the_products_of_matrices) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const auto numbers = [&](int rows, int columns) -> MatrixXd {
    return MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
  };
  for (const int m : {1, 7, 8, 29})
    for (const int columns : {1, 3, 4, 13})
      for (const int k : {1, 16, 21}) {
        const MatrixXd A = numbers(m + 3, k), B = numbers(k + 2, columns);
        MatrixXd C = numbers(m + 1, columns), exact = C;
        exact.topRows(m) -= A.topRows(m) * B.topRows(k);
        simd::dense().subtract_product(m, columns, k, A.data(), m + 3, B.data(), k + 2, C.data(), m + 1);
        EXPECT_LT((C - exact).cwiseAbs().maxCoeff(), 1e-13);
        EXPECT_EQ(C.row(m), exact.row(m));
      }
  for (const int n : {1, 4, 7, 32, 45}) {
    MatrixXd A = numbers(n + 2, n);
    const VectorXd x = numbers(n, 1), before = numbers(n, 1);
    const MatrixXd lower = A.topRows(n).triangularView<Eigen::Lower>(),
                   strict = A.topRows(n).triangularView<Eigen::StrictlyLower>();
    VectorXd y = before;
    simd::dense().symmetric_product(n, A.data(), n + 2, x.data(), y.data());
    EXPECT_LT((y - before - (lower + strict.transpose()) * x).cwiseAbs().maxCoeff(), 1e-13);
  }
  for (const int n : {1, 45, 128, 129})
    for (const int used : {0, n / 3, n}) {
      const MatrixXd half = numbers(n + 2, n);
      MatrixXd A = half;
      A.topRows(n) += half.topRows(n).transpose();
      VectorXd x = numbers(n, 1), y = numbers(n, 1);
      const VectorXd before = y;
      x.tail(n - used).setZero();
      simd::add_product(n, A.data(), n + 2, x.data(), y.data());
      EXPECT_LT((y - before - A.topRows(n) * x).cwiseAbs().maxCoeff(), 1e-12) << "sums of 129 terms";
    }
  for (const int rows : {1, 4, 31}) {
    const MatrixXd A = numbers(rows + 2, 6), y = numbers(6, 1);
    VectorXd x = numbers(rows + 1, 1), exact = x;
    exact.head(rows) -= A.topRows(rows) * y;
    {
      simd::ColumnSum sum(rows, x.data());
      for (int k = 0; k < 6; ++k) sum.subtract(&A(0, k), y(k));
    }
    EXPECT_LT((x - exact).cwiseAbs().maxCoeff(), 1e-13);
    EXPECT_EQ(x(rows), exact(rows));
  }
}

TEST(DenseLoops, give_the_products_of_rows) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  const auto numbers = [&](int rows, int columns) -> MatrixXd {
    return MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
  };
  for (const int rows : {0, 3, 6, 15})
    for (const int n : {1, 7, 8, 45}) {
      const MatrixXd A = numbers(n + 2, rows);  // a row in each column
      const VectorXd x = numbers(n, 1), y = numbers(rows, 1), before = numbers(n + 1, 1);
      VectorXd products = VectorXd::Zero(rows), sum = before;
      simd::dense().row_products(rows, n, A.data(), n + 2, x.data(), products.data());
      simd::dense().add_rows(rows, n, A.data(), n + 2, y.data(), sum.data());
      EXPECT_LT((products - A.topRows(n).transpose() * x).norm(), 1e-13 * (1 + rows));
      // Bit by bit: a step may compute a product with another one or alone.
      const VectorXd other = numbers(n, 1);
      VectorXd again = products, of_other = products;
      const std::array<const double*, 2> vectors{other.data(), x.data()};
      const std::array<double*, 2> both{of_other.data(), again.data()};
      simd::dense().two_row_products(rows, n, A.data(), n + 2, vectors.data(), both.data());
      EXPECT_EQ(again, products);
      EXPECT_LT((of_other - A.topRows(n).transpose() * other).norm(), 1e-13 * (1 + rows));
      EXPECT_LT((sum.head(n) - before.head(n) - A.topRows(n) * y).norm(), 1e-13 * (1 + rows));
      EXPECT_EQ(sum(n), before(n));
    }
}

TEST(DenseLoops, give_the_norms_of_matrices) {
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  for (const int size : {0, 1, 7, 8, 45}) {
    MatrixXd A = MatrixXd::NullaryExpr(size + 2, size, [&] { return normal(random); });
    A.topRows(size) = (A.topRows(size) + A.topRows(size).transpose()).eval();
    const double exact = size > 0 ? A.topRows(size).cwiseAbs().rowwise().sum().maxCoeff() : 0;
    EXPECT_NEAR(simd::dense().norm(size, A.data(), size + 2), exact, 1e-14 * exact);
  }
}

// A step of modes without forces moves them as far, to round-off of three terms.
TEST(DenseLoops, move_modes_freely) {
  std::mt19937_64 random(10);
  std::normal_distribution<double> normal;
  for (const int size : {1, 8, 45}) {
    const MatrixXd x = MatrixXd::NullaryExpr(size, 11, [&] { return normal(random); });
    const auto column = [&](int j) { return &x(0, j); };
    const simd::Oscillators modes{column(0), column(1), column(2), column(3), column(4),
                                  column(5), column(6), column(7), column(8), column(8)};
    const VectorXd none = VectorXd::Zero(size);
    VectorXd dq(size), q(size), v(size);
    double work[2] = {0, 0};
    simd::dense().free_motion(size, modes, column(9), column(10), dq.data());
    simd::dense().move_modes(size, modes, none.data(), column(9), column(10), q.data(), v.data(), work);
    EXPECT_LT((x.col(9) + dq - q).cwiseAbs().maxCoeff(), 1e-15 * (1 + x.cwiseAbs().maxCoeff()) * 50);
  }
}

// The oracle sums over vectors of Eigen; round-off of sums of 45 terms.
TEST(DenseLoops, add_the_energies_of_modes) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  for (const int size : {1, 8, 45}) {
    const MatrixXd x = MatrixXd::NullaryExpr(size, 6, [&] { return normal(random); });
    const auto column = [&](int j) { return &x(0, j); };
    double energy[3] = {1, 2, 3};
    simd::dense().add_energy(size, column(0), column(1), column(2), column(3), column(4), column(5), energy);
    EXPECT_NEAR(energy[0], 1 + 0.5 * (x.col(5) + x.col(3)).squaredNorm(), 1e-13 * size);
    EXPECT_NEAR(energy[1], 2 + 0.5 * x.col(0).dot(x.col(4).cwiseAbs2()), 1e-13 * size);
    EXPECT_NEAR(energy[2], 3 + x.col(1).dot(x.col(4) - x.col(2)), 1e-13 * size);
  }
}

// Levers with one candidate or two, one row or three, on a body of five candidates. The oracle multiplies
// whole matrices: D W (a M + R) Wᵀ Dᵀ, and D (a/m − r̂ a J⁻¹ r̂) Dᵀ of the frame.
TEST(DenseLoops, give_the_flexibility_of_levers) {
  std::mt19937_64 random(8);
  std::normal_distribution<double> normal;
  const auto numbers = [&](int rows, int columns) -> MatrixXd {
    return MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
  };
  constexpr int candidates = 5, points = 9;
  constexpr double a = 0.625, shift = 0.3;
  const MatrixXd half = numbers(15, 15), other_half = numbers(15, 15), turn = numbers(3, 3);
  const MatrixXd M = half * half.transpose(), R = other_half * other_half.transpose();
  const Eigen::Matrix3d J = turn * turn.transpose();
  constexpr std::size_t height = 16;  // of columns, to the next cache line
  MatrixXd M_stored = MatrixXd::Constant(height, 15, NAN), R_stored = M_stored;
  M_stored.topRows(15) = M;
  R_stored.topRows(15) = R;
  simd::Yield body{
      .M = M_stored.data(), .R = R_stored.data(), .stride = height, .share = a, .shift = shift, .turn = {}};
  Eigen::Map<Eigen::Matrix3d>(body.turn[0]) = J;

  std::vector<simd::Lever> levers;
  MatrixXd W = MatrixXd::Zero(3 * points, 15), frame = MatrixXd::Zero(3 * points, 6);
  std::size_t n = 0;
  for (std::size_t f = 0; f < points; ++f) {
    simd::Lever lever{.row = {},
                      .arm = {},
                      .weight = {f % 2 == 0 ? 1 : 0.25, 0.75},
                      .at = {f % candidates, (f + 2) % candidates},
                      .count = 1 + f % 2,
                      .first = n,
                      .rows = f == 4 ? 1u : 3u};
    const MatrixXd D = numbers(3, 3);
    const Eigen::Vector3d r = numbers(3, 1);
    Eigen::Map<Eigen::Vector3d>(lever.arm) = r;
    for (int x = 0; x < 3; ++x)
      for (int y = 0; y < 3; ++y) lever.row[x][y] = D(x, y);
    const auto rows = static_cast<int>(lever.rows), first = static_cast<int>(n);
    for (std::size_t j = 0; j < lever.count; ++j)
      W.block(first, 3 * static_cast<int>(lever.at[j]), rows, 3) += lever.weight[j] * D.topRows(rows);
    for (int x = 0; x < rows; ++x) {
      const Eigen::Vector3d d = D.row(x);
      frame.row(first + x) << d.transpose(), r.cross(d).transpose();
    }
    n += lever.rows;
    levers.push_back(lever);
  }
  const auto size = static_cast<int>(n), stride = (size + 7) / 8 * 8;
  MatrixXd rigid = MatrixXd::Zero(6, 6);
  rigid.topLeftCorner(3, 3) = shift * MatrixXd::Identity(3, 3);
  rigid.bottomRightCorner(3, 3) = J;
  // Forces on all levers but the second one, whose rows are left out of the vectors
  std::vector<simd::Pull> pulls;
  std::vector<int> rows;
  for (std::size_t f = 0; f < points; ++f) {
    if (f == 1) continue;
    pulls.push_back({f, rows.size()});
    for (std::size_t x = 0; x < levers[f].rows; ++x) rows.push_back(static_cast<int>(levers[f].first + x));
  }
  const auto pulled = static_cast<int>(rows.size());
  const MatrixXd p = numbers(pulled, 1), before = numbers(pulled, 1);
  MatrixXd y = before;
  std::vector<double> scratch(6 * candidates + 16, NAN);
  simd::dense().yield(candidates, R_stored.data(), height, levers.data(), pulls.data(), pulls.size(),
                      p.data(), scratch.data(), y.data());
  const MatrixXd of_R = (W * R * W.transpose())(rows, rows), moved = of_R * p;
  EXPECT_LT((y - before - moved).cwiseAbs().maxCoeff(), 1e-14 * of_R.cwiseAbs().rowwise().sum().maxCoeff());

  for (const bool has_residual : {true, false}) {
    if (!has_residual) body.R = nullptr;
    const MatrixXd yields = has_residual ? MatrixXd(a * M + R) : MatrixXd(a * M);
    const MatrixXd exact =
        (W * yields * W.transpose() + frame * rigid * frame.transpose()).topLeftCorner(size, size);
    MatrixXd found = MatrixXd::Constant(stride, size, NAN);
    std::vector<double> u(7 * height), out;
    for (std::size_t f = 0; f < points; ++f) {
      const bool adds = f % 2 == 0;  // to 0, or sets what was undefined
      out.assign(static_cast<std::size_t>(4 * stride), adds ? 0 : NAN);
      simd::dense().displace(body, &levers[f], points - f, 0, candidates, u.data(), adds, out.data());
      simd::dense().spread(n, levers[f].first, levers[f].rows, out.data(), found.data(),
                           static_cast<std::size_t>(stride));
    }
    EXPECT_TRUE(found.topRows(size).allFinite());
    EXPECT_LT((found.topRows(size) - exact).cwiseAbs().maxCoeff(), 1e-14 * exact.cwiseAbs().maxCoeff());
  }
}

// Sizes below, at and above those of the blocks. The oracle multiplies instead of dividing; it takes the sign
// of the determinant from Eigen. 1e-15 n: the backward error of elimination with row exchanges, with little
// growth.
TEST(PivotedFactor, solves_for_a_vector_that_was_multiplied) {
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal;
  PivotedFactor factor(211);
  for (const int size : {1, 8, 9, 31, 33, 64, 65, 130, 211}) {
    const MatrixXd A = MatrixXd::NullaryExpr(size, size, [&] { return normal(random); });
    factor.begin(size) = A;
    factor.factor();
    const VectorXd b = VectorXd::NullaryExpr(size, [&] { return normal(random); });
    VectorXd x = b;
    ASSERT_TRUE(factor.solve(x.data()));
    EXPECT_LT((A * x - b).norm(), 1e-15 * size * (A.norm() * x.norm() + b.norm())) << size;
    const Eigen::PartialPivLU<MatrixXd> exact(A);
    EXPECT_EQ(factor.sign(0),
              exact.permutationP().determinant() * exact.matrixLU().diagonal().array().sign().prod())
        << size;
  }
}

class Bordered : public testing::Test {
 protected:
  Bordered() {
    std::normal_distribution<double> normal;
    whole_ = MatrixXd::NullaryExpr(n + b, n + b, [&] { return normal(random_); });
    factor_.begin(n) = whole_.topLeftCorner(n, n);
    factor_.factor();
  }

  /// Appends entries of the whole matrix up to `last`.
  void append_to(int last) {
    const int first = factor_.border();
    for (int i = first; i < last; ++i) {
      factor_.append();
      VectorXd::Map(factor_.column(i), n) = whole_.col(n + i).head(n);
      VectorXd::Map(factor_.row(i), n) = whole_.row(n + i).head(n);
      for (int j = 0; j <= i; ++j) {
        factor_.corner(i, j) = whole_(n + i, n + j);
        factor_.corner(j, i) = whole_(n + j, n + i);
      }
    }
    factor_.complete(first);
  }

  void expect_solution(const MatrixXd& matrix) {
    const int border = factor_.border();
    ASSERT_EQ(matrix.rows(), n + border);
    std::normal_distribution<double> normal;
    const VectorXd right = VectorXd::NullaryExpr(n + border, [&] { return normal(random_); });
    VectorXd x = right;
    ASSERT_TRUE(factor_.solve(x.data(), x.data() + n));
    const Eigen::FullPivLU<MatrixXd> lu(matrix);
    const VectorXd exact = lu.solve(right);
    // round-off times the condition of J, which is below 1e5 here
    EXPECT_LE((x - exact).cwiseAbs().maxCoeff(), 1e-9 * exact.cwiseAbs().maxCoeff());
    EXPECT_EQ(factor_.sign(1e-9), lu.determinant() > 0 ? 1 : -1);
  }

  std::mt19937_64 random_{3};
  MatrixXd whole_;
  BorderedFactor factor_{n + b};
};

TEST_F(Bordered, solves_without_a_border) { expect_solution(whole_.topLeftCorner(n, n)); }

TEST_F(Bordered, solves_after_the_border_has_grown) {
  for (const int border : {1, 4, b}) {
    append_to(border);
    expect_solution(whole_.topLeftCorner(n + border, n + border));
  }
}

TEST_F(Bordered, solves_after_entries_have_left) {
  append_to(b);
  const std::vector<int> kept{1, 2, 5, 8};
  factor_.keep(kept.data(), static_cast<int>(kept.size()));
  factor_.complete(static_cast<int>(kept.size()));
  std::vector<int> rows;
  for (int i = 0; i < n; ++i) rows.push_back(i);
  for (const int i : kept) rows.push_back(n + i);
  expect_solution(whole_(rows, rows));
}

}  // namespace
}  // namespace ricochet::contact
