// SPDX-License-Identifier: BSD-2-Clause
// Contact problems of every kind, and harder ones. Results are compared with Lemke's method and with known
// solutions, and checked against the complementarity conditions in extended precision.
#include <gtest/gtest.h>

#include "contact/complementarity/complementarity.hpp"
#include "tests/contact/lcp.hpp"

namespace complementarity_bench_test {

using namespace lcp;
using ricochet::contact::ComplementaritySolver;
using ricochet::contact::SolveStatus;

// The solver guarantees w_i ≥ −1e-13. For pressed points, w_i = 0 holds to the round-off of a
// backward stable solve of up to 1000 unknowns.
constexpr double holds = 1e-12;

/// Compares status and objective with Lemke's method and checks the conditions. Unlike λ, the
/// objective is the same for all solutions.
void expect_as_lemke(ComplementaritySolver& solver, const MatrixXd& S, const VectorXd& r) {
  VectorXd lambda(r.size());
  const SolveStatus status = solver.solve(S, r, lambda);
  const auto other = by_lemke(S, r);
  ASSERT_EQ(status, other ? SolveStatus::solved : SolveStatus::no_solution) << "S\n"
                                                                            << S << "\nr " << r.transpose();
  if (!other) return;
  ASSERT_LE(violation(S, r, lambda), holds) << "S\n" << S << "\nr " << r.transpose();
  const Long mine = objective(S, r, lambda), his = objective(S, r, *other);
  ASSERT_LE(std::abs(mine - his), 1e-11L * (1 + std::abs(his))) << "S\n" << S << "\nr " << r.transpose();
}

TEST(ComplementarityBench, agrees_with_lemke_on_random_problems_of_any_size_to_sixty) {
  Random random(1);
  ComplementaritySolver solver(60);
  for (int trial = 0; trial < 300; ++trial) {
    const Index n = 1 + trial % 60;
    const MatrixXd B = normal_matrix(random, n, n + 5);
    expect_as_lemke(solver, B * B.transpose(), normal_vector(random, n));
    if (HasFatalFailure()) return;
  }
}

// With small integers, ranks, ties and null directions are exact, so solvability is unambiguous. Some points
// occur twice, some touch without force, and some have rows of zeros.
TEST(ComplementarityBench, agrees_with_lemke_on_ten_thousand_singular_problems_solvable_or_not) {
  Random random(2);
  std::uniform_int_distribution<int> small(-3, 3), size(1, 12), any(0, 1 << 20);
  ComplementaritySolver solver(12);
  int refused = 0;
  for (int trial = 0; trial < 10000; ++trial) {
    const Index n = size(random), rank = any(random) % (n + 2);
    MatrixXd B = MatrixXd::NullaryExpr(n, rank, [&] { return small(random); });
    VectorXd r = VectorXd::NullaryExpr(n, [&] { return small(random); });
    if (trial % 2 == 1) r = B * VectorXd::NullaryExpr(rank, [&] { return small(random); });  // solvable
    for (int twin = any(random) % 3; twin > 0; --twin) {
      const Index from = any(random) % n, to = any(random) % n;
      B.row(to) = B.row(from);
      r(to) = r(from);
    }
    expect_as_lemke(solver, B * B.transpose(), r);
    if (HasFatalFailure()) return;
    refused += by_lemke(B * B.transpose(), r).has_value() ? 0 : 1;
  }
  EXPECT_GT(refused, 1000);
  EXPECT_LT(refused, 5000);
}

TEST(ComplementarityBench, finds_the_solution_of_problems_made_from_one) {
  Random random(3);
  for (const Index n : {10, 100, 300}) {
    ComplementaritySolver solver(static_cast<int>(n));
    for (const double condition : {1e0, 1e3, 1e6, 1e9, 1e12})
      for (const bool degenerate : {false, true}) {
        const MatrixXd S = with_condition(random, n, condition);
        const Known problem = known(random, S, degenerate);
        VectorXd lambda(n);
        ASSERT_EQ(solver.solve(S, problem.r, lambda), SolveStatus::solved) << n << ' ' << condition;
        EXPECT_LE(violation(S, problem.r, lambda), holds) << n << ' ' << condition;
        // The error e of a λ that violates the conditions by τ satisfies
        // eᵀSe ≤ 2 τ |e|_1, and S ≥ 1/condition.
        const VectorXd error = lambda - problem.lambda;
        const double tolerance = 1e-12 * scale(S, problem.r, lambda);
        EXPECT_LE(error.dot(S * error), 2 * tolerance * error.lpNorm<1>() + 1e-15) << n << ' ' << condition;
        if (condition <= 1e3) {
          EXPECT_LE(error.cwiseAbs().maxCoeff(), 1e-13 * n * condition);
        }
      }
  }
}

TEST(ComplementarityBench, holds_for_hilbert_matrices_singular_to_round_off) {
  Random random(4);
  for (const Index n : {4, 12, 40, 200, 1000}) {
    ComplementaritySolver solver(static_cast<int>(n));
    const MatrixXd S = hilbert(n);
    for (int trial = 0; trial < (n < 1000 ? 20 : 3); ++trial) {
      const VectorXd x = normal_vector(random, n).cwiseAbs();  // λ = x balances the push S x
      const VectorXd gap = trial % 2 == 0 ? VectorXd::Zero(n) : normal_vector(random, n).cwiseAbs().eval();
      const VectorXd r = S * x - gap;
      VectorXd lambda(n);
      ASSERT_EQ(solver.solve(S, r, lambda), SolveStatus::solved) << n << ' ' << trial;
      EXPECT_LE(violation(S, r, lambda), holds) << n << ' ' << trial;
    }
  }
}

// Stiff and soft points in one problem. All w have the same unit and the same tolerance.
TEST(ComplementarityBench, holds_for_rows_scaled_over_twelve_decades) {
  Random random(5);
  std::uniform_real_distribution<double> exponent(-6, 6);
  ComplementaritySolver solver(60);
  for (int trial = 0; trial < 200; ++trial) {
    const Index n = 2 + trial % 59;
    const VectorXd D = VectorXd::NullaryExpr(n, [&] { return std::pow(10, exponent(random)); });
    const MatrixXd S = D.asDiagonal() * with_condition(random, n, 100) * D.asDiagonal();
    const VectorXd r = D.asDiagonal() * normal_vector(random, n);
    VectorXd lambda(n);
    ASSERT_EQ(solver.solve(S, r, lambda), SolveStatus::solved) << trial;
    ASSERT_LE(violation(S, r, lambda), holds) << trial;
  }
}

// As in models without residual flexibility, every set of more than 120 points is dependent.
TEST(ComplementarityBench, holds_for_a_thousand_points_on_a_hundred_and_twenty_modes) {
  Random random(7);
  const Index n = 1000, modes = 120;
  ComplementaritySolver solver(n);
  for (int trial = 0; trial < 3; ++trial) {
    const MatrixXd B = normal_matrix(random, n, modes);
    const MatrixXd S = B * B.transpose();
    // A motion q that contact must undo, and gaps. A λ exists because no point touches at q = 0.
    const VectorXd r = B * normal_vector(random, modes) - normal_vector(random, n).cwiseAbs();
    VectorXd lambda(n);
    ASSERT_EQ(solver.solve(S, r, lambda), SolveStatus::solved) << trial;
    EXPECT_LE(violation(S, r, lambda), holds) << trial;
    EXPECT_LE((lambda.array() > 0).count(), modes);
  }
}

/// A pressed zone whose position and width oscillate, with small random bumps:
/// contact that drifts from step to step.
VectorXd drifting(Random& random, Index n, double t) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const double middle = 0.5 + 0.25 * std::sin(t), width = 0.13 + 0.05 * std::cos(1.7 * t);
  return VectorXd::NullaryExpr(n, [&](Index i) {
    const double x = (static_cast<double>(i) / static_cast<double>(n) - middle) / width;
    return 1 - x * x + 1e-4 * unit(random) + 0.02 * std::sin(40 * x + 9 * t);
  });
}

// In 20 000 steps, thousands of points enter and leave one factor, which is never recomputed.
TEST(ComplementarityBench, keeps_its_factor_through_a_long_drift) {
  Random random(9);
  const Index n = 150;
  const int steps = 20000;
  const MatrixXd S = exponential(n);
  ComplementaritySolver keeps(n, {.same_matrix = true}), afresh(n);
  VectorXd lambda(n), other(n);
  for (int k = 0; k < steps; ++k) {
    const VectorXd r = drifting(random, n, 1e-3 * k);
    ASSERT_EQ(keeps.solve(S, r, lambda), SolveStatus::solved) << k;
    if (k % 20 != 0) continue;
    ASSERT_LE(violation(S, r, lambda), 1e-13) << k;
    afresh.reset();
    ASSERT_EQ(afresh.solve(S, r, other), SolveStatus::solved) << k;
    ASSERT_LE((lambda - other).cwiseAbs().maxCoeff(), 1e-10) << k;  // condition 400, |λ| up to 3
  }
  const auto& statistics = keeps.statistics();
  EXPECT_GT(statistics.warm_hits, 0.6 * steps);
  EXPECT_LT(statistics.warm_hits, 0.95 * steps);
  EXPECT_GT(statistics.pivots, 5000);
  EXPECT_EQ(statistics.renewals, 0);
  EXPECT_EQ(statistics.fallbacks, 0);
  EXPECT_GT(statistics.max_active, 40);
}

// The matrix is always singular: points enter by exchange, and the factor of a dependent set is never kept.
TEST(ComplementarityBench, keeps_its_factor_where_points_outnumber_modes) {
  Random random(10);
  const Index n = 60, modes = 25;
  const MatrixXd B = normal_matrix(random, n, modes), S = B * B.transpose();
  ComplementaritySolver keeps(n, {.same_matrix = true});
  VectorXd lambda(n), q = normal_vector(random, modes);
  const VectorXd gap = normal_vector(random, n).cwiseAbs();
  for (int k = 0; k < 3000; ++k) {
    q = 0.999 * q + 0.03 * normal_vector(random, modes);
    const VectorXd r = B * q - gap;
    ASSERT_EQ(keeps.solve(S, r, lambda), SolveStatus::solved) << k;
    ASSERT_LE(violation(S, r, lambda), holds) << k;
  }
  EXPECT_GT(keeps.statistics().pivots, 1000);
}

}  // namespace complementarity_bench_test
