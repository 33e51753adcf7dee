// SPDX-License-Identifier: BSD-2-Clause
// Complementarity problems 0 ≤ λ ⟂ Sλ − r ≥ 0 for tests: their conditions in extended precision, and Lemke's
// method, which is independent of active sets.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "tests/orthonormal.hpp"

namespace lcp {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Long = long double;
using LongMatrix = Eigen::Matrix<Long, Eigen::Dynamic, Eigen::Dynamic>;
using LongVector = Eigen::Matrix<Long, Eigen::Dynamic, 1>;

/// w = Sλ − r.
inline LongVector slack(const MatrixXd& S, const VectorXd& r, const VectorXd& lambda) {
  LongVector w = -r.cast<Long>();
  for (Index j = 0; j < r.size(); ++j)
    if (lambda(j) != 0) w += static_cast<Long>(lambda(j)) * S.col(j).cast<Long>();
  return w;
}

/// Reference magnitude for the tolerance of w.
inline double scale(const MatrixXd& S, const VectorXd& r, const VectorXd& lambda) {
  return r.cwiseAbs().maxCoeff() + S.cwiseAbs().rowwise().sum().maxCoeff() * lambda.cwiseAbs().maxCoeff();
}

/// Largest violation of 0 ≤ λ ⟂ Sλ − r ≥ 0, relative to |r|_∞ + ‖S‖_∞ |λ|_∞; infinite if any λ < 0.
inline double violation(const MatrixXd& S, const VectorXd& r, const VectorXd& lambda) {
  if (!(lambda.array() >= 0).all()) return std::numeric_limits<double>::infinity();
  const LongVector w = slack(S, r, lambda);
  double worst = 0;
  for (Index i = 0; i < r.size(); ++i)
    worst = std::max(worst, static_cast<double>(lambda(i) > 0 ? std::abs(w(i)) : -w(i)));
  return worst > 0 ? worst / scale(S, r, lambda) : 0;
}

/// F(λ) = ½ λᵀSλ − rᵀλ.
inline Long objective(const MatrixXd& S, const VectorXd& r, const VectorXd& lambda) {
  return 0.5L * lambda.cast<Long>().dot(slack(S, r, lambda) - r.cast<Long>());
}

/// Lemke's method (1965) with the lexicographic rule against cycling, on a dense tableau in
/// extended precision. Returns λ, or nullopt if the method ends in a ray: for a semidefinite S
/// there is then no solution (Cottle, Pang & Stone 1992, 4.4.12). Two ratios are considered
/// equal if they differ by at most `tie`.
inline std::optional<VectorXd> by_lemke(const MatrixXd& S, const VectorXd& r, Long tie = 1e-13L) {
  const Index n = r.size(), artificial = 2 * n, right = 2 * n + 1;
  if ((r.array() <= 0).all()) return VectorXd::Zero(n);
  // w − Sλ − e z₀ = −r. Columns: w, λ, z₀, right-hand side.
  LongMatrix T = LongMatrix::Zero(n, 2 * n + 2);
  T.leftCols(n).setIdentity();
  T.middleCols(n, n) = -S.cast<Long>();
  T.col(artificial).setConstant(-1);
  T.col(right) = -r.cast<Long>();
  std::vector<Index> basis(static_cast<std::size_t>(n));
  for (Index i = 0; i < n; ++i) basis[i] = i;

  const auto precedes = [&](Index i, Index k, Index column) {  // row i lexicographically before row k
    const Long a = T(i, column), b = T(k, column);
    for (Index c = -1; c < n; ++c) {
      const Long x = T(i, c < 0 ? right : c) / a, y = T(k, c < 0 ? right : c) / b;
      if (std::abs(x - y) > tie * (1 + std::abs(x) + std::abs(y))) return x < y;
    }
    return false;
  };
  const auto pivot = [&](Index row, Index column) {
    T.row(row) /= T(row, column);
    for (Index i = 0; i < n; ++i)
      if (i != row && T(i, column) != 0) T.row(i) -= T(i, column) * T.row(row).eval();
    return std::exchange(basis[row], column);
  };

  Index row = 0;  // z₀ = the largest r; of equal ones, the last is lexicographically least in −r
  for (Index i = 1; i < n; ++i)
    if (T(i, right) <= T(row, right)) row = i;
  Index entering = artificial;
  for (int step = 0; step < 200 * (n + 10); ++step) {
    const Index left = pivot(row, entering);
    if (left == artificial) {
      VectorXd lambda = VectorXd::Zero(n);
      for (Index i = 0; i < n; ++i)
        if (basis[i] >= n) lambda(basis[i] - n) = std::max<double>(0, static_cast<double>(T(i, right)));
      return lambda;
    }
    entering = left < n ? left + n : left - n;
    row = -1;
    const Long least = 1e-14L * (1 + T.col(entering).cwiseAbs().maxCoeff());
    for (Index i = 0; i < n; ++i)
      if (T(i, entering) > least && (row < 0 || precedes(i, row, entering))) row = i;
    if (row < 0) return std::nullopt;
    for (Index i = 0; i < n; ++i)  // in a tie, z₀ leaves the basis and ends the method
      if (basis[i] == artificial && T(i, entering) > least &&
          T(i, right) / T(i, entering) <= T(row, right) / T(row, entering) + tie)
        row = i;
  }
  return std::nullopt;
}

using Random = std::mt19937;

inline VectorXd normal_vector(Random& random, Index n) {
  std::normal_distribution<double> normal;
  return VectorXd::NullaryExpr(n, [&] { return normal(random); });
}
inline MatrixXd normal_matrix(Random& random, Index n, Index m) {
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(n, m, [&] { return normal(random); });
}

/// Q D Qᵀ with D logarithmically spaced from 1 to 1/condition.
inline MatrixXd with_condition(Random& random, Index n, double condition) {
  const MatrixXd Q = ricochet::test::orthonormal(normal_matrix(random, n, n));
  const VectorXd D = VectorXd::NullaryExpr(n, [&](Index k) {
    return std::pow(condition, -static_cast<double>(k) / static_cast<double>(std::max<Index>(n - 1, 1)));
  });
  const MatrixXd S = Q * D.asDiagonal() * Q.transpose();
  return 0.5 * (S + S.transpose());
}

inline MatrixXd hilbert(Index n) {
  return MatrixXd::NullaryExpr(n, n, [](Index i, Index j) { return 1.0 / static_cast<double>(i + j + 1); });
}

/// Flexibility that decays with distance, with a condition number of about (4/rate)².
inline MatrixXd exponential(Index n, double rate = 0.2) {
  return MatrixXd::NullaryExpr(
      n, n, [=](Index i, Index j) { return std::exp(-rate * static_cast<double>(std::abs(i - j))); });
}

/// A problem constructed from its solution.
struct Known {
  VectorXd lambda, r;
};

/// Each index is, at random, pushing (λ in [0.1, 1.1]), open (w in [0.1, 1.1]) or, with `degenerate`,
/// touching without a force (λ = w = 0).
inline Known known(Random& random, const MatrixXd& S, bool degenerate) {
  std::uniform_real_distribution<double> unit(0.1, 1.1);
  std::uniform_int_distribution<int> kind(0, degenerate ? 2 : 1);
  Known out{VectorXd::Zero(S.rows()), {}};
  VectorXd w = VectorXd::Zero(S.rows());
  for (Index i = 0; i < S.rows(); ++i) switch (kind(random)) {
      case 0:
        out.lambda(i) = unit(random);
        break;
      case 1:
        w(i) = unit(random);
        break;
      default:
        break;
    }
  out.r = (slack(S, w, out.lambda)).cast<double>();
  return out;
}

}  // namespace lcp
