// SPDX-License-Identifier: BSD-2-Clause
// Guarantees for a solve that max_pivots has stopped.
#include <gtest/gtest.h>

#include "contact/complementarity/complementarity.hpp"
#include "tests/contact/lcp.hpp"

namespace complementarity_limits_test {

using namespace lcp;
using ricochet::contact::ComplementaritySolver;
using ricochet::contact::SolveStatus;

/// The objective F at the optimal multiple of λ.
Long best_objective_along(const MatrixXd& S, const VectorXd& r, const VectorXd& lambda) {
  const LongVector x = lambda.cast<Long>();
  const Long gain = x.dot(r.cast<Long>()), quadratic = x.dot(slack(S, 0 * r, lambda));
  return gain > 0 ? -0.5L * gain * gain / quadratic : 0;
}

/// The minimiser on the active set of `before`, with negative forces set to 0.
VectorXd clipped_start(const MatrixXd& S, const VectorXd& r, const VectorXd& before) {
  std::vector<Index> P;
  for (Index i = 0; i < r.size(); ++i)
    if (before(i) > 0) P.push_back(i);
  VectorXd lambda = VectorXd::Zero(r.size());
  if (!P.empty()) lambda(P) = S(P, P).ldlt().solve(r(P)).cwiseMax(0);
  return lambda;
}

void expect_promises(const ComplementaritySolver& solver, const MatrixXd& S, const VectorXd& r,
                     const VectorXd& lambda, const VectorXd& before) {
  ASSERT_TRUE((lambda.array() >= 0).all());
  const double size = scale(S, r, lambda);
  const double round_off = 1e-13 * size * (1 + lambda.sum());
  const LongVector w = slack(S, r, lambda);
  const Long work = lambda.cast<Long>().dot(w);
  ASSERT_LE(std::abs(work), round_off);
  ASSERT_LE(objective(S, r, lambda), round_off);
  ASSERT_LE(objective(S, r, lambda), best_objective_along(S, r, clipped_start(S, r, before)) + round_off);
  ASSERT_NEAR(solver.residual().violation, static_cast<double>(std::max(-w.minCoeff(), Long(0))),
              1e-13 * size);
  ASSERT_LE(solver.residual().scale, size * (1 + 1e-12));
  ASSERT_LE(solver.residual().work, round_off);
}

TEST(LimitedSolve, is_feasible_does_no_work_and_is_no_worse_than_its_start) {
  Random random(1);
  int limited = 0, improved = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Index n = 2 + trial % 40;
    const MatrixXd B = normal_matrix(random, n, n + 5), S = B * B.transpose();
    for (const int most : {1, 2, 5}) {
      ComplementaritySolver solver(static_cast<int>(n), {.same_matrix = true, .max_pivots = most});
      VectorXd lambda = VectorXd::Zero(n), r = normal_vector(random, n);
      for (int k = 0; k < 10; ++k) {
        // The start is an active set that was solved. After a limited solve, no start is known.
        const VectorXd before = solver.statistics().limited == 0 ? lambda : VectorXd::Zero(n);
        const auto pivots = solver.statistics().pivots;
        const SolveStatus status = solver.solve(S, r, lambda);
        ASSERT_LE(solver.statistics().pivots - pivots, most + 1);
        if (status == SolveStatus::limited) {
          expect_promises(solver, S, r, lambda, before);
          if (HasFatalFailure()) return;
          ++limited;
          improved += objective(S, r, lambda) < 0;
        } else {
          ASSERT_EQ(status, SolveStatus::solved);
          ASSERT_LE(violation(S, r, lambda), 1e-12);
          ASSERT_EQ(solver.residual().violation, 0);
        }
        if (k > 2) r += 0.1 * normal_vector(random, n);
      }
    }
  }
  EXPECT_GT(limited, 3000);
  EXPECT_GT(improved, 0.8 * limited);
}

TEST(LimitedSolve, keeps_its_promises_from_a_solved_start_that_pulls) {
  Random random(2);
  int limited = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const Index n = 20;
    const MatrixXd S = with_condition(random, n, 1e4);
    ComplementaritySolver solver(n, {.same_matrix = true, .max_pivots = 4});
    VectorXd before = VectorXd::Zero(n), lambda(n);
    const VectorXd r = normal_vector(random, n);
    SolveStatus status = SolveStatus::limited;
    for (int k = 0; k < 100 && status == SolveStatus::limited; ++k) status = solver.solve(S, r, before);
    ASSERT_EQ(status, SolveStatus::solved);
    const VectorXd next = normal_vector(random, n);
    ComplementaritySolver stopped = solver;  // the copy has its own statistics
    if (stopped.solve(S, next, lambda) != SolveStatus::limited) continue;
    expect_promises(stopped, S, next, lambda, before);
    if (HasFatalFailure()) return;
    ++limited;
  }
  EXPECT_GT(limited, 300);
}

// Every problem has more points than the bodies can move, so that active sets become singular and the solver
// leaves them along null directions. Each round adds a push along the null space, after which there is no
// solution.
TEST(LimitedSolve, keeps_its_promises_on_singular_problems_solvable_or_not) {
  Random random(6);
  std::uniform_int_distribution<int> small(-2, 2);
  int limited = 0, refused = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const Index n = 4 + trial % 12, rank = 1 + trial % 3;
    const MatrixXd B = MatrixXd::NullaryExpr(n, rank, [&] { return small(random); }), S = B * B.transpose();
    VectorXd r = B * VectorXd::NullaryExpr(rank, [&] { return small(random); });
    const bool solvable = trial % 2 == 0;
    if (!solvable)
      for (Index i = 0; i < n; ++i) r(i) += small(random);
    VectorXd exact(n), lambda(n);
    ComplementaritySolver unlimited(static_cast<int>(n));
    const SolveStatus end = unlimited.solve(S, r, exact);
    if (solvable) {
      ASSERT_EQ(end, SolveStatus::solved);
    }
    for (const int most : {1, 2, 3}) {
      ComplementaritySolver solver(static_cast<int>(n), {.same_matrix = true, .max_pivots = most});
      SolveStatus status = SolveStatus::limited;
      Long before = 0;
      for (int call = 0; status == SolveStatus::limited; ++call) {
        ASSERT_LT(call, 50 * n) << trial;
        const auto pivots = solver.statistics().pivots;
        status = solver.solve(S, r, lambda);
        ASSERT_LE(solver.statistics().pivots - pivots, most + 1) << trial;  // an exchange is one step
        if (status != SolveStatus::limited) break;
        expect_promises(solver, S, r, lambda, VectorXd::Zero(n));
        if (HasFatalFailure()) return;
        before = objective(S, r, lambda);
        ++limited;
      }
      ASSERT_EQ(status, end) << trial << ' ' << most;
      if (status == SolveStatus::solved) {
        ASSERT_LE(violation(S, r, lambda), 1e-12) << trial;
        ASSERT_LE(objective(S, r, lambda), before + 1e-12L * (1 + std::abs(before)));
      } else {
        ASSERT_EQ(lambda, VectorXd::Zero(n));
        ++refused;
      }
    }
  }
  EXPECT_GT(limited, 1000);
  EXPECT_GT(refused, 300);
}

TEST(LimitedSolve, goes_on_where_it_was_stopped_and_ends_at_the_solution) {
  Random random(3);
  for (int trial = 0; trial < 600; ++trial) {
    const Index n = 1 + trial % 30;
    // Every third matrix is singular, but the problem is solvable.
    const MatrixXd B = normal_matrix(random, n, trial % 3 == 0 ? 1 + n / 2 : n + 2), S = B * B.transpose();
    const VectorXd r = B * normal_vector(random, B.cols()) - normal_vector(random, n).cwiseAbs();
    VectorXd exact(n), lambda(n);
    ComplementaritySolver unlimited(static_cast<int>(n));
    ASSERT_EQ(unlimited.solve(S, r, exact), SolveStatus::solved);
    for (const int most : {1, 3, 10}) {
      ComplementaritySolver solver(static_cast<int>(n), {.same_matrix = true, .max_pivots = most});
      int calls = 1;
      while (solver.solve(S, r, lambda) == SolveStatus::limited && calls < 50 * n) ++calls;
      ASSERT_LE(violation(S, r, lambda), 1e-12) << trial << ' ' << most;
      ASSERT_LE(std::abs(objective(S, r, lambda) - objective(S, r, exact)),
                1e-10L * (1 + std::abs(objective(S, r, exact))));
      ASSERT_EQ(solver.statistics().limited, calls - 1);
    }
  }
}

}  // namespace complementarity_limits_test
