// SPDX-License-Identifier: BSD-2-Clause
// Newton's method for contact problems with springs (patch_spring.hpp):
//
//   0 ≤ λ  ⟂  w = S p + s(λ) − r ≥ 0      and Coulomb's law in tangential rows
//
// Each round linearises the springs at forces x, s(λ) ≈ s(x) + D (λ − x), and solves a linear problem with
// the matrix S + D. D is the slope s'(x) of an earlier round or problem while rounds with it converge fast;
// otherwise it is renewed, which costs a factor of S + D. Where all springs are full or without force, D does
// not change.
//
// Where x = 0, the linear problem has s = D λ, so that a point opens if and only if w ≥ 0 without its force.
// s'(0) is infinite: a point that closes, or that the tangent opened, continues from the force that it would
// have if all others kept theirs. A problem that has not converged after many rounds continues with secants,
// D = s(x)/x: ∫ s dλ is concave in λ², so that without friction each such round reduces the objective.
#pragma once

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "contact/complementarity/complementarity.hpp"
#include "contact/complementarity/patch_spring.hpp"

namespace ricochet::contact {

/// Only the constructor allocates.
class SpringNewton {
 public:
  using Right = Eigen::Ref<const Eigen::VectorXd>;
  using Forces = Eigen::Ref<Eigen::VectorXd>;

  /// @param rows  capacity; 0 if no problem has springs   @param options  of the linear problems
  SpringNewton(int rows, const SolveOptions& options);

  /// @param S, r  as for the linear problem   @param springs  of the first rows; with `same_matrix`, the same
  /// ones as in the solve before
  /// @param p  (n) in: a guess, such as the forces of the step before; out: the answer
  /// @param linear  solves the problem without springs: linear(S + D, right side, whether S + D has changed,
  /// p) returns its status
  /// s(λ) is met to 1e-12 of itself. `limited`: too many rounds, or a linear problem was limited. Then
  /// pᵀ(r − S p) ≥ λᵀs(λ), so that contact gives no energy.
  template <class Linear>
  SolveStatus solve(const Symmetric& S, const Right& r, std::span<const PatchSpring> springs, Forces p,
                    Linear&& linear) noexcept {
    begin(S, r, springs, p);
    for (int round = 0;; ++round) {
      set_right(r);
      const bool renewed = renewed_;
      renewed_ = false;
      const SolveStatus status = linear(matrix(), Right(right_.head(r.size())), renewed, p);
      if (status == SolveStatus::limited) {
        hold_back(S, r, p);
        return status;
      }
      if (status != SolveStatus::solved) {
        reset();
        return status;
      }
      if (is_met(p)) return status;
      if (round + 1 >= most_rounds_) {
        ++stopped_;
        hold_back(S, r, p);
        return SolveStatus::limited;
      }
      improve(S, r, p, round);
    }
  }

  /// Discards the matrix.
  void reset() noexcept { known_ = 0; }
  /// Problems that were left after the largest number of rounds.
  std::int64_t stopped() const { return stopped_; }
  double misfit() const { return misfit_; }  ///< of the last answer: largest error of s(λ) [m]

  void archive(auto& a) {
    a(known_, rows_, slope_, at_, right_, renewed_, largest_r_, misfit_, error_, before_, closed_, stopped_);
    if (known_ > matrix_.cols()) return a.fail();
    for (Eigen::Index j = 0; j < known_; ++j)
      a.entries(matrix_.col(j).data(), static_cast<std::size_t>(known_));
  }

 private:
  void begin(const Symmetric& S, const Right& r, std::span<const PatchSpring> springs,
             const Forces& p) noexcept;
  void set_right(const Right& r) noexcept;
  bool is_met(const Forces& p) noexcept;
  void improve(const Symmetric& S, const Right& r, const Forces& p, int round) noexcept;
  double alone(const Symmetric& S, const Right& r, const Forces& p, int i) const noexcept;
  void hold_back(const Symmetric& S, const Right& r, Forces p) const noexcept;
  void set_slope(const Symmetric& S, int i, double slope) noexcept;
  Symmetric matrix() const { return matrix_.topLeftCorner(known_, known_); }

  bool same_matrix_;
  int most_rounds_;
  std::span<const PatchSpring> springs_;  ///< of the present problem
  std::vector<int> rows_;                 ///< with a spring
  Eigen::Index known_ = 0;                ///< size of the matrix
  Eigen::MatrixXd matrix_;                ///< (n,n) S + D
  Eigen::VectorXd slope_, at_, right_;    ///< (n) D; x; right side
  bool renewed_ = false;                  ///< whether matrix_ has changed since the last linear problem
  double largest_r_ = 0, misfit_ = 0;
  double error_ = 0, before_ = 0;  ///< of s(λ), relative to the tolerance: in this round, in the last one
  int closed_ = 0;                 ///< rows with a force in this round
  std::int64_t stopped_ = 0;
};

}  // namespace ricochet::contact
