// SPDX-License-Identifier: BSD-2-Clause
// The solver compared with enumeration of all active sets, and checked against the
// complementarity conditions in extended precision.
#include "contact/complementarity/complementarity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include "tests/contact/heap_counter.hpp"
#include "tests/contact/lcp.hpp"

namespace complementarity_test {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using lcp::violation;
using ricochet::contact::ComplementaritySolver;
using ricochet::contact::SolveStatus;

/// w = Sλ − r of a solution, found by trying every active set with independent rows. Each solvable problem
/// has a solution with such a set. Unlike λ, w is the same for all solutions of a semidefinite problem.
std::optional<VectorXd> by_enumeration(const MatrixXd& S, const VectorXd& r) {
  const int n = static_cast<int>(r.size());
  const double tol = 1e-9 * (1 + r.cwiseAbs().maxCoeff());
  for (unsigned set = 0; set < (1u << n); ++set) {
    std::vector<int> P;
    for (int i = 0; i < n; ++i)
      if (set >> i & 1u) P.push_back(i);
    VectorXd lambda = VectorXd::Zero(n);
    if (!P.empty()) {
      const Eigen::FullPivLU<MatrixXd> lu(S(P, P));
      if (!lu.isInvertible()) continue;
      lambda(P) = lu.solve(r(P));
    }
    const VectorXd w = S * lambda - r;
    if (lambda.minCoeff() >= -tol && w.minCoeff() >= -tol) return w;
  }
  return std::nullopt;
}

void expect_as_enumerated(ComplementaritySolver& solver, const MatrixXd& S, const VectorXd& r) {
  VectorXd lambda(r.size());
  const SolveStatus status = solver.solve(S, r, lambda);
  const auto w = by_enumeration(S, r);
  ASSERT_EQ(status == SolveStatus::solved, w.has_value()) << "S\n" << S << "\nr " << r.transpose();
  if (!w) {
    EXPECT_EQ(status, SolveStatus::no_solution);
    EXPECT_EQ(lambda, VectorXd::Zero(r.size()));
    return;
  }
  EXPECT_LE(violation(S, r, lambda), 1e-12)
      << "S\n"
      << S << "\nr " << r.transpose() << "\nlambda " << lambda.transpose();
  EXPECT_LE((S * lambda - r - *w).cwiseAbs().maxCoeff(), 1e-8 * (1 + r.cwiseAbs().maxCoeff()));
}

// With small integers, ranks, ties and null directions are exact, so solvability is unambiguous.
TEST(Complementarity, agrees_with_enumeration_on_singular_problems_solvable_or_not) {
  std::mt19937 random(2);
  std::uniform_int_distribution<int> small(-2, 2);
  ComplementaritySolver solver(9);
  int refused = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const int n = 1 + trial % 9, rank = trial / 9 % 5;
    const MatrixXd B = MatrixXd::NullaryExpr(n, rank, [&] { return small(random); });
    const MatrixXd S = rank > 0 ? MatrixXd(B * B.transpose()) : MatrixXd(MatrixXd::Zero(n, n));
    const VectorXd r = VectorXd::NullaryExpr(n, [&] { return small(random); });
    expect_as_enumerated(solver, S, r);
    if (HasFatalFailure()) return;
    VectorXd lambda(n);
    refused += solver.solve(S, r, lambda) == SolveStatus::no_solution;
  }
  EXPECT_GT(refused, 300);
  EXPECT_GT(solver.statistics().fallbacks, 300);
}

// A wedge between two nearly parallel walls and a third wall opposite them: S d = 0 for
// d = (1/α, 1/α, 1) ≥ 0, so no force resists a push along d. r = B y contains no such push,
// rᵀd = 0. This product and w of the last wall, however, are known only to round-off
// multiplied by |d|, and the solver must not mistake this error for a push.
TEST(Complementarity, holds_a_wedge_whose_balance_is_known_to_round_off_only) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> unit(0, 1);
  ComplementaritySolver solver(3);
  for (int trial = 0; trial < 1000; ++trial) {
    const double angle = std::pow(10, -3 - 3 * unit(random));
    MatrixXd B(3, 2);
    B << 1, 0, -1, angle, 0, -1;
    const MatrixXd S = B * B.transpose();
    const VectorXd r = B * Eigen::Vector2d(unit(random), unit(random));
    VectorXd lambda(3);
    ASSERT_EQ(solver.solve(S, r, lambda), SolveStatus::solved) << trial;
    EXPECT_LE(violation(S, r, lambda), 1e-13 * (1 + 2 / angle)) << trial;
  }
}

TEST(Complementarity, refuses_a_push_along_the_null_space) {
  ComplementaritySolver solver(2);
  MatrixXd S(2, 2);
  S << 1, -1, -1, 1;
  VectorXd lambda(2);
  EXPECT_EQ(solver.solve(S, Eigen::Vector2d(1, 1), lambda), SolveStatus::no_solution);
  EXPECT_EQ(lambda, VectorXd::Zero(2));
  EXPECT_EQ(solver.solve(S, Eigen::Vector2d(1, -1), lambda), SolveStatus::solved);
  EXPECT_NEAR(lambda(0) - lambda(1), 1, 1e-15);
  EXPECT_EQ(solver.solve(MatrixXd::Zero(2, 2), Eigen::Vector2d(-1, 1e-3), lambda), SolveStatus::no_solution);
}

TEST(Complementarity, refuses_what_is_not_a_number) {
  ComplementaritySolver solver(2);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  VectorXd lambda(2);
  EXPECT_EQ(solver.solve(MatrixXd::Identity(2, 2), Eigen::Vector2d(1, nan), lambda), SolveStatus::not_finite);
  EXPECT_EQ(solver.solve(MatrixXd::Constant(2, 2, nan), Eigen::Vector2d(1, 1), lambda),
            SolveStatus::not_finite);
  MatrixXd S = MatrixXd::Identity(2, 2);
  S(0, 1) = S(1, 0) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(solver.solve(S, Eigen::Vector2d(1, -1), lambda), SolveStatus::not_finite);
  EXPECT_EQ(solver.solve(MatrixXd::Identity(2, 2), Eigen::Vector2d(1, -1), lambda), SolveStatus::solved);
  EXPECT_EQ(lambda, Eigen::Vector2d(1, 0));
}

MatrixXd exponential_kernel(int n) {
  return MatrixXd::NullaryExpr(n, n, [](Eigen::Index i, Eigen::Index j) {
    return std::exp(-0.2 * static_cast<double>(std::abs(i - j)));
  });
}

TEST(Complementarity, reads_and_writes_nothing_outside_the_problem) {
  const double poison = std::numeric_limits<double>::quiet_NaN();
  ComplementaritySolver solver(12);
  VectorXd lambda(12);
  ASSERT_EQ(solver.solve(exponential_kernel(12), VectorXd::Ones(12), lambda),
            SolveStatus::solved);  // warm start with too many points
  MatrixXd S = MatrixXd::Constant(12, 12, poison);
  S.block(3, 2, 5, 5) = exponential_kernel(5);
  VectorXd r = VectorXd::Constant(12, poison);
  r.segment(4, 5) = VectorXd::LinSpaced(5, 1, -1);
  lambda.setConstant(7);
  ASSERT_EQ(solver.solve(S.block(3, 2, 5, 5), r.segment(4, 5), lambda.segment(1, 5)), SolveStatus::solved);
  EXPECT_LE(violation(exponential_kernel(5), VectorXd::LinSpaced(5, 1, -1), lambda.segment(1, 5)), 1e-13);
  EXPECT_EQ(lambda(0), 7);
  EXPECT_EQ(lambda.tail(6), VectorXd::Constant(6, 7));
}

#if RICOCHET_HEAP_COUNTED
TEST(HeapCounter, counts_new_and_the_temporaries_of_eigen) {
  const long start = heap_counter::calls;
  ::operator delete(::operator new(8));  // called by name, because the compiler may omit a new-expression
  const long after_new = heap_counter::calls;
  const VectorXd x = VectorXd::Ones(100);
  const long after_eigen = heap_counter::calls;
  EXPECT_EQ(after_new, start + 1);
  EXPECT_EQ(after_eigen, after_new + 1);
  EXPECT_EQ(x.sum(), 100);
}

TEST(Complementarity, takes_no_memory_in_ten_thousand_problems) {
  const int n = 40;
  ComplementaritySolver solver(n);
  std::mt19937 random(5);
  std::uniform_int_distribution<int> small(-2, 2);
  const MatrixXd B = MatrixXd::NullaryExpr(n, 15, [&] { return small(random); }),
                 singular = B * B.transpose();
  const MatrixXd regular = exponential_kernel(n);
  VectorXd lambda(n), r(n);
  const long before = heap_counter::calls;
  for (int k = 0; k < 10000; ++k) {
    for (int i = 0; i < n; ++i) r(i) = small(random);
    solver.solve(k % 2 ? regular : singular, r, lambda);
  }
  const long after = heap_counter::calls;
  EXPECT_EQ(after, before);
  EXPECT_GT(solver.statistics().fallbacks, 1000);
}
#endif

}  // namespace complementarity_test
