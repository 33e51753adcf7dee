// SPDX-License-Identifier: BSD-2-Clause
// Linear complementarity problems of a symmetric positive semidefinite matrix, solved exactly:
//
//   0 ≤ λ  ⟂  w = S λ − r ≥ 0      ⇔      minimise F(λ) = ½ λᵀ S λ − rᵀ λ over λ ≥ 0
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <limits>
#include <vector>

#include "contact/complementarity/active_set.hpp"

namespace ricochet::contact {

enum class SolveStatus {
  solved,
  limited,  ///< max_pivots was reached: λ ≥ 0 and λᵀw = 0, but w ≥ 0 holds only to within residual()
  no_solution,  ///< S is singular and r pushes along its null space: no λ closes the gap
  not_finite,   ///< r, the diagonal of S or a column in use contains a NaN or an infinity
};

inline bool has_forces(SolveStatus status) noexcept {
  return status == SolveStatus::solved || status == SolveStatus::limited;
}

struct SolveOptions {
  /// Whether all problems have the same matrix S. Its factor is then kept from one solve to the next, until
  /// reset().
  bool same_matrix = false;
  /// Bound on the work of a solve: the number of indices that may change sides. Each change costs O(p²), and
  /// each round of changes costs a product S_·P λ_P.
  int max_pivots = std::numeric_limits<int>::max();
};

/// Violation of complementarity by the last answer; all 0 unless it was `limited`.
struct SolveResidual {
  double violation = 0;  ///< max −w_i, in units of r
  double scale = 0;      ///< |r|_∞ + ‖S_·P‖_∞ |λ|_∞, to which the tolerance of w is relative
  double work = 0;       ///< |λᵀw|, which is round-off

  void archive(auto& a) { a(violation, scale, work); }
};

/// Statistics since construction. They do not influence the solver.
struct SolveStatistics {
  std::int64_t problems = 0;
  std::int64_t warm_hits = 0;  ///< solved by the active set of the previous problem
  std::int64_t pivots = 0;     ///< indices that changed sides
  std::int64_t fallbacks = 0;  ///< solves that needed the primal active-set method
  std::int64_t renewals = 0;   ///< factors recomputed for another matrix, O(p³) each
  std::int64_t limited = 0;    ///< stopped by max_pivots
  int max_active = 0;

  void archive(auto& a) { a(problems, warm_hits, pivots, fallbacks, renewals, limited, max_active); }
};

SolveStatistics operator+(const SolveStatistics& a, const SolveStatistics& b);

/// Solves by block principal pivoting, which starts from the previous active set. If the pivoting cycles or
/// meets a singular active set, a primal active-set method takes over. That method is finite, because the
/// objective decreases strictly; it leaves singular active sets along their null direction. Only the
/// constructor allocates.
class ComplementaritySolver {
 public:
  /// @param capacity  largest problem size m
  explicit ComplementaritySolver(int capacity, const SolveOptions& options = {});

  /// @param S  (n,n) symmetric positive semidefinite, n ≤ capacity, both triangles
  /// @param r  (n)
  /// @param lambda  (n) out: λ ≥ 0, exactly 0 off the active set
  /// Complementarity holds to round-off: w_i ≥ −tol with tol = 1e-13 (|r|_∞ + ‖S‖_∞ |λ|_∞). For a row that
  /// depends on active rows, S_i = −Σ d_P S_P, tol is larger by the factor 1 + |d|_1, because the error of
  /// λ_P reaches w_i through d.
  /// With the status `limited`, F(λ) is at most F(0). It is also at most F at the minimiser on the initial
  /// active set, after tension is cut off and the rest scaled optimally. The next solve continues from the
  /// active set reached. If there is no solution or a value is not finite, λ is 0.
  SolveStatus solve(const Symmetric& S, const Eigen::Ref<const Eigen::VectorXd>& r,
                    Eigen::Ref<Eigen::VectorXd> lambda) noexcept;

  /// Discards the warm start and, with `same_matrix`, the matrix.
  void reset() noexcept;
  /// With `same_matrix`: the next problem has another matrix of the same size. The warm start is kept.
  void change_matrix() noexcept { known_ = 0; }
  const SolveStatistics& statistics() const { return statistics_; }
  const SolveResidual& residual() const { return residual_; }

  /// The warm start, which the forces of later problems depend on to the last bit.
  void archive(auto& a) {
    a(statistics_, residual_, active_set_, known_, warm_, stopped_, descending_, entered_, changed_, budget_);
    a(refused_, z_, x_, leaving_, entering_, rows_, w_, weight_, root_, seen_, heaviest_, tolerance_, best_);
  }

 private:
  using Right = Eigen::Ref<const Eigen::VectorXd>;

  bool know(const Symmetric& S) noexcept;
  bool renew(const Symmetric& S) noexcept;
  bool enter(const Symmetric& S, int j, bool trusted) noexcept;
  void drop(const Symmetric& S, int position) noexcept;
  SolveStatus pivot(const Symmetric& S, const Right& r) noexcept;
  SolveStatus descend(const Symmetric& S, const Right& r) noexcept;
  bool evaluate(const Symmetric& S, const Right& r, const std::vector<double>& on_set) noexcept;
  void find_infeasible(int n) noexcept;
  void cut_to_budget() noexcept;
  bool move_on_active_set(const Symmetric& S, const Right& r) noexcept;
  bool exchange(const Symmetric& S, int j) noexcept;
  bool bounded() const { return options_.max_pivots < std::numeric_limits<int>::max(); }
  void offer(const Symmetric& S, const Right& r, const std::vector<double>& on_set) noexcept;
  void answer_with_best(const Symmetric& S, const Right& r, Eigen::Ref<Eigen::VectorXd> lambda) noexcept;

  /// The λ at which all rows were last evaluated, here called μ, with f = S μ.
  struct Seen {
    Eigen::VectorXd push;                       ///< (n) f
    double sum = 0, square = 0, tolerance = 0;  ///< |μ|_1, μᵀf, tolerance of f
    void archive(auto& a) { a(push, sum, square, tolerance); }
  };

  /// The best feasible λ so far.
  struct Best {
    double objective = 0;  ///< F
    int count = 0;
    std::vector<int> index;
    std::vector<double> value;
    void archive(auto& a) { a(objective, count, index, value); }
  };
  /// What a solve may still do.
  struct Budget {
    int pivots = 0;
    int fewest = 0, rounds = 0;  ///< least number of infeasible indices; remaining rounds to reduce it
    void archive(auto& a) { a(pivots, fewest, rounds); }
  };

  SolveOptions options_;
  SolveStatistics statistics_;
  SolveResidual residual_;
  ActiveSet active_set_;     ///< P
  Eigen::Index known_ = 0;   ///< size of the matrix whose factor and diagonal are stored
  bool warm_ = false;        ///< P belongs to a solved problem
  bool stopped_ = false;     ///< the previous problem was `limited`
  bool descending_ = false;  ///< it stopped in `descend`, with x_ feasible
  int entered_ = -1;         ///< index that entered last in `descend`
  bool changed_ = true;      ///< whether P has changed since heaviest_ was computed
  Budget budget_;
  std::vector<char> refused_;                   ///< (n) dependent rows found consistent
  std::vector<double> z_, x_;                   ///< (p) minimiser on the active set, current λ_P
  std::vector<int> leaving_, entering_, rows_;  ///< positions in P, ascending; indices; rows of w to compute
  Eigen::VectorXd w_, weight_, root_;  ///< (n) w, or 0 if it cannot be negative; Σ_P |S_ij|; √S_ii
  Seen seen_;
  double heaviest_ = 0;   ///< max weight_
  double tolerance_ = 0;  ///< of w, for the last λ evaluated
  Best best_;
};

}  // namespace ricochet::contact
