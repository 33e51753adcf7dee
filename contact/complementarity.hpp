// Linear complementarity problems of a symmetric positive semidefinite matrix, solved exactly:
//
//   0 ≤ λ  ⟂  w = S λ − r ≥ 0      ⇔      minimise ½ λᵀ S λ − rᵀ λ over λ ≥ 0
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <vector>

namespace ricochet::contact {

enum class SolveStatus {
  solved,
  no_solution,  ///< S is singular and r pushes along its null space: no λ closes the gap
  not_finite,   ///< r, the diagonal of S or a column that is used holds a NaN or an infinity
};

/// Passive statistics since construction.
struct SolveStatistics {
  std::int64_t problems = 0;
  std::int64_t warm_hits = 0;  ///< solved by the active set of the problem before
  std::int64_t pivots = 0;     ///< block pivots
  std::int64_t fallbacks = 0;  ///< finite fallback entered
  int max_active = 0;
};

/// Active set with warm start; block principal pivoting; a finite primal active-set method (strictly
/// decreasing objective, singular faces followed along their null direction) where those cycle or meet a
/// singular face. Allocates in the constructor only.
class ComplementaritySolver {
 public:
  /// @param capacity  largest problem size m
  explicit ComplementaritySolver(int capacity);

  /// @param S  (n,n) symmetric positive semidefinite, n ≤ capacity, both triangles
  /// @param r  (n)
  /// @param lambda  (n) out: λ ≥ 0, exactly 0 off the active set
  /// Complementarity holds to round-off: w_i ≥ −tol, tol = 1e-13 (|r|_∞ + ‖S‖_∞ |λ|_∞); for a row that
  /// depends on active rows, S_i = −Σ d_P S_P, tol is (1 + |d|_1) times that, because the error of λ_P
  /// reaches w_i through d. Unless the status is `solved`, λ is 0.
  SolveStatus solve(const Eigen::Ref<const Eigen::MatrixXd>& S, const Eigen::Ref<const Eigen::VectorXd>& r,
                    Eigen::Ref<Eigen::VectorXd> lambda) noexcept;

  /// Forget the warm start.
  void reset() noexcept;
  const SolveStatistics& statistics() const { return statistics_; }

 private:
  using Problem = Eigen::Ref<const Eigen::MatrixXd>;
  using Right = Eigen::Ref<const Eigen::VectorXd>;

  SolveStatus pivot(const Problem& S, const Right& r) noexcept;
  SolveStatus descend(const Problem& S, const Right& r) noexcept;
  bool enter(const Problem& S, int j, bool trusted) noexcept;
  bool factor(const Problem& S, int from, bool trusted) noexcept;
  void drop(int position) noexcept;
  void minimise_on_face(const Right& r) noexcept;
  bool move_on_face(const Problem& S, const Right& r) noexcept;
  bool exchange(const Problem& S, int j) noexcept;
  void evaluate(const Problem& S, const Right& r, const std::vector<double>& on_face) noexcept;
  double* row(int k) { return factor_.data() + static_cast<std::size_t>(k) * stride_; }

  SolveStatistics statistics_;
  std::size_t stride_;
  int count_ = 0;                          ///< p, size of the active set P
  bool warm_ = false;                      ///< P is that of a solved problem
  std::vector<int> active_;                ///< (p) P, in the order of the factor's rows
  std::vector<char> is_active_, refused_;  ///< (n) membership of P; dependent rows found consistent
  std::vector<double> factor_;             ///< (p,p) L of S_PP = L Lᵀ, row-major; row p is scratch
  std::vector<double> z_, x_, d_;          ///< (p) minimiser on the face, current λ_P, null direction
  std::vector<int> next_;                  ///< (n) scratch
  Eigen::VectorXd w_, weight_;             ///< (n) w and Σ_P |S_ij|
  double tolerance_ = 0;                   ///< of w, for the λ last evaluated
};

}  // namespace ricochet::contact
