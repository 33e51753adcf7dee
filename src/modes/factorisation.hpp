// SPDX-License-Identifier: BSD-2-Clause
// Factorisation of K − σM by MUMPS: inertia and block solves.
#pragma once

#include <Eigen/Dense>
#include <Eigen/SparseCore>
#include <memory>
#include <span>

#include "src/modes/entries.hpp"
#include "src/parallel/teams.hpp"

namespace ricochet::modes {

class Mumps;

/// Factorisation L D Lᵀ of K − σM at one shift after another. The inertia of full-rank factors is exact.
/// Block low-rank factors need less time and memory for large bodies, but their solutions are approximate.
///
/// MUMPS is called directly, not through PETSc, so that METIS orders the elimination by nested dissection of
/// the nodes, once for all shifts.
class Factorisation {
 public:
  /// Copies the matrices and runs the analysis. Collective on the ranks of the matrices.
  /// @param stiffness, mass  SBAIJ with the same pattern
  /// @param low_rank  relative threshold of block low-rank factors; 0 for full rank
  /// Throws SolverError if MUMPS breaks down.
  /// Source: Amestoy, Buttari, L'Excellent & Mary 2019 (block low-rank in MUMPS).
  Factorisation(Mat stiffness, Mat mass, double low_rank = 0);
  ~Factorisation();
  Factorisation(const Factorisation&) = delete;
  Factorisation& operator=(const Factorisation&) = delete;

  /// Factors K − σM, unless it was factored last. If the matrix is singular, σ is raised by a millionth of
  /// its magnitude. Collective. Throws SolverError if memory is insufficient or MUMPS breaks down.
  /// @param sigma  [rad²/s²]
  void factor(double sigma);

  /// Factors K with a spring as stiff as its diagonal at each of the given rows, like static_flexibility.
  /// Collective. Throws SolverError like `factor`.
  /// @param on_springs  global rows, the same on every rank
  void factor_on_springs(std::span<const std::int64_t> on_springs);

  double sigma() const { return sigma_; }  ///< shift of the factors

  /// Number of eigenvalues below σ (Sylvester's law of inertia). Valid for full-rank factors only.
  std::int64_t below() const { return below_; }

  /// Solves (K − σM) X = B. Collective.
  /// @param right  B (local rows, n)
  /// @return X (local rows, n)
  Eigen::MatrixXd solve(const Eigen::Ref<const Eigen::MatrixXd>& right);

  /// Frees the factors. Collective.
  void release();

  /// Returns the memory that a factorisation needs on this rank, as estimated by MUMPS [MiB].
  double expected_mib() const;

  const Entries& entries() const { return entries_; }
  /// On the first rank, the place of each row in the order of elimination, from 1.
  const std::vector<int>& order() const { return order_; }

 private:
  void analyse();
  void return_rows(const Eigen::MatrixXd& eliminated, Eigen::MatrixXd& solution) const;

  MPI_Comm comm_ = MPI_COMM_NULL;
  std::unique_ptr<Mumps> mumps_;
  Entries entries_;
  std::vector<int> order_;
  std::vector<double> shifted_;
  std::vector<int> first_of_rank_;  ///< first row of each rank
  /// Numbers from 1 of the rows of this rank, and of those whose pivots it has eliminated.
  std::vector<int> own_row_, eliminated_row_;
  double low_rank_ = 0;
  double sigma_ = 0;
  bool factored_ = false;
  std::int64_t below_ = 0;
};

/// Solves for right-hand sides that are the same in every team. Each team solves for a part of the columns.
/// The factors of all teams must have the same shift. Collective on all ranks of `teams`.
/// @return (local rows, n), the same in every team
Eigen::MatrixXd shared_solve(const parallel::Teams& teams, Factorisation& factor,
                             const Eigen::Ref<const Eigen::MatrixXd>& right);

/// Returns XᵀY, summed over the ranks and the same on each. Collective.
Eigen::MatrixXd inner(MPI_Comm comm, const Eigen::Ref<const Eigen::MatrixXd>& x,
                      const Eigen::Ref<const Eigen::MatrixXd>& y);
Eigen::MatrixXd inner(MPI_Comm comm, const Eigen::SparseMatrix<double>& x, const Eigen::MatrixXd& y);

}  // namespace ricochet::modes
