// SPDX-License-Identifier: BSD-2-Clause
// The forces of a step at points with Coulomb friction, of all points together:
//
//   w = S p − r          p [N] forces, w [m] gaps of normal rows, and minus the slip of tangential rows
//   normal rows          0 ≤ p_n  ⟂  w_n ≥ 0
//   tangential rows      |p_t| ≤ μ p_n,   w_t ≠ 0  ⇒  p_t = −μ p_n w_t / |w_t|
//
// The method is Newton's on sets of open, sticking and slipping points (Alart & Curnier 1991), helped by
// block Gauss-Seidel over points (Jourdan, Alart & Jean 1998); Acary & Brogliato 2008 describe both. What
// differs here: a slipping point has two unknowns instead of three, so that every iterate is in the cone; a
// factor is kept, and updated where states change (friction_factor.cpp), while that is cheaper than a new
// one; a path of regularised problems follows where both methods fail (friction_system.hpp); and single
// points are solved exactly (friction_point.hpp).
#pragma once

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "contact/complementarity/complementarity.hpp"
#include "contact/complementarity/friction_system.hpp"

namespace ricochet::contact {

/// A point with friction: its normal row, and the first of its two consecutive tangential rows.
struct FrictionContact {
  int normal, tangential;
  double coefficient;  ///< μ ≥ 0
};

struct FrictionOptions {
  /// Whether all problems have the same matrix S. Parts of it are then kept from one solve to the next, until
  /// reset().
  bool same_matrix = false;
  /// Bound on the work of a solve: Newton steps, O(p³) or, with a kept factor, O(p²), and sweeps, O(p²).
  int max_iterations = 1000;
};

/// Only the constructor allocates.
class FrictionSolver {
 public:
  /// @param capacity  largest number of rows n
  explicit FrictionSolver(int capacity, const FrictionOptions& options = {});

  /// @param S  (n,n) symmetric positive semidefinite, n ≤ capacity, both triangles
  /// @param r  (n)
  /// @param contacts  with the same rows in each solve until reset(); μ may change. Other rows are normal
  /// rows without friction. Without contacts, the answer is that of ComplementaritySolver.
  /// @param p  (n) in: a guess, such as the forces of the step before; out: exactly 0 at open points,
  /// otherwise in the cone to round-off
  /// Conditions on w hold to 1e-12 (|r|_∞ + ‖S‖_∞ |p|_∞), with |r|_∞ over normal rows alone for gaps. A point
  /// that slips by less than that sticks.
  ///
  /// With the status `limited`, p is in the cone and pᵀ(r − S p) ≥ 0, so that contact gives no energy. If
  /// there is no solution or a value is not finite, p is 0.
  SolveStatus solve(const Symmetric& S, const Eigen::Ref<const Eigen::VectorXd>& r,
                    std::span<const FrictionContact> contacts, Eigen::Ref<Eigen::VectorXd> p) noexcept;

  /// Discards what is known of S and of the contacts.
  void reset() noexcept;
  /// With `same_matrix`: the next problem has another matrix with the same contacts. Their states are kept,
  /// and the factor, which serves as long as it is near enough to converge fast.
  void change_matrix() noexcept { changed_ = true; }

  /// Here, pivots are rounds that changed states, fallbacks are solves that Newton's method alone did not
  /// end, and renewals are factors, O(p³) each.
  const SolveStatistics& statistics() const { return statistics_; }
  const SolveResidual& residual() const { return residual_; }
  /// Sets out to S p, without a product, if all rows touch and the solver has multiplied these forces.
  bool product(const Eigen::Ref<const Eigen::VectorXd>& p, Eigen::Ref<Eigen::VectorXd> out) noexcept;
  /// (contacts) of the last answer.
  std::span<const ContactState> states() const { return {states_.data(), contact_count_}; }
  /// Whether the last answer is known not to be the only one. This is exact for problems of a single point.
  /// For several, it is true if a determinant proves it, or if another solution was found from other forces
  /// of a point with S_nn ≤ μ |S_nt|.
  bool several() const { return several_; }

  void archive(auto& a) {
    a(statistics_, residual_, several_, frictionless_, system_, known_, point_count_, contact_count_,
      changed_);
    a(gathered_, largest_r_, largest_normal_r_, points_, touching_, runs_, states_, slips_, root_, forces_);
  }

 private:
  using Right = Eigen::Ref<const Eigen::VectorXd>;
  using Forces = Eigen::Ref<Eigen::VectorXd>;

  struct Point {
    int normal = 0, tangential = -1, contact = -1;
    double coefficient = 0;
    bool touches = false;
    int row(int k) const { return k == 0 ? normal : tangential + k - 1; }
    void archive(auto& a) { a(normal, tangential, contact, coefficient, touches); }
  };

  bool know(const Symmetric& S, std::span<const FrictionContact> contacts) noexcept;
  void choose_none() noexcept;
  void choose(const Forces& p) noexcept;
  void add(int k) noexcept;
  void list_runs() noexcept;
  void gather(const Symmetric& S, const Right& r) noexcept;
  bool add_closing(const Symmetric& S, const Right& r) noexcept;
  bool is_unsolvable(const Symmetric& S, const Right& r) noexcept;
  SolveStatus iterate(const Symmetric& S, const Right& r, Forces p) noexcept;
  void answer(Forces p) noexcept;
  void limit(const Symmetric& S, const Right& r, Forces p) noexcept;

  /// Consecutive rows of the problem that are consecutive in the system.
  struct Run {
    int row, of_system, size;
    void archive(auto& a) { a(row, of_system, size); }
  };

  FrictionOptions options_;
  SolveStatistics statistics_;
  SolveResidual residual_;
  bool several_ = false;
  ComplementaritySolver frictionless_;
  FrictionSystem system_;
  Eigen::Index known_ = 0;  ///< size of the matrix that is known
  int point_count_ = 0;
  std::size_t contact_count_ = 0;
  bool changed_ = false;                         ///< whether the matrix that is known has changed
  bool gathered_ = false;                        ///< whether the system has the matrix of its points
  double largest_r_ = 0, largest_normal_r_ = 0;  ///< |r|_∞, and over normal rows
  std::vector<Point> points_;                    ///< all normal rows, those of contacts first
  std::vector<int> touching_;                    ///< points of the system
  std::vector<Run> runs_;                        ///< their rows
  std::vector<ContactState> states_;
  std::vector<double> slips_;             ///< |w_t| of slip
  Eigen::VectorXd root_, work_, forces_;  ///< (n) √S_ii; scratch
  ReservedMatrix normal_;                 ///< scratch
};

}  // namespace ricochet::contact
