// SPDX-License-Identifier: BSD-2-Clause
// K − σM factored by MUMPS: inertia and block solves.
#pragma once

#include <Eigen/Dense>
#include <memory>

#include "src/parallel/teams.hpp"

namespace ricochet::modes {

/// L D Lᵀ of K − σM at one shift after another. The inertia of full-rank factors is exact; block low-rank
/// factors take less time and memory on large bodies, but solve approximately.
///
/// MUMPS is called directly, not through PETSc: the elimination order is METIS's nested dissection of the
/// nodes, computed once for all shifts (Debian's MUMPS only has PORD, which leaves up to twice the entries).
class Factorisation {
 public:
  /// Analysis. Collective on the ranks of the matrices.
  /// @param stiffness, mass  SBAIJ with one pattern; they must outlive this object
  /// @param low_rank  relative threshold of block low-rank factors; 0: full rank
  /// Throws SolverError if MUMPS breaks down.
  /// Source: Amestoy, Buttari, L'Excellent & Mary 2019 (block low-rank in MUMPS).
  Factorisation(Mat stiffness, Mat mass, double low_rank = 0);
  ~Factorisation();
  Factorisation(const Factorisation&) = delete;
  Factorisation& operator=(const Factorisation&) = delete;

  /// Factors K − σM unless it was factored last; if it is singular, at a shift larger by a millionth.
  /// Collective. @param sigma  [rad²/s²]. Throws SolverError: not enough memory, breakdown.
  void factor(double sigma);

  double sigma() const { return sigma_; }  ///< shift of the factors

  /// Number of eigenvalues below σ (Sylvester's law of inertia). Valid for full-rank factors only.
  std::int64_t below() const { return below_; }

  /// Solves (K − σM) X = B. @param right  B (local rows, n). @return X, likewise. Collective.
  Eigen::MatrixXd solve(const Eigen::Ref<const Eigen::MatrixXd>& right);

  /// Memory that MUMPS expects to need on this rank for a factorisation [MiB].
  double expected_mib() const;

 private:
  struct Mumps;
  void order_by_metis(Mat stiffness);
  void collect_entries(Mat stiffness, Mat mass);
  void take_users_options();
  void run(int job, const char* task);
  void succeed(const char* task) const;

  MPI_Comm comm_ = MPI_COMM_NULL;
  std::unique_ptr<Mumps> mumps_;
  std::vector<int> row_, column_, order_;
  std::vector<double> stiffness_, mass_, shifted_;
  std::vector<int> rows_of_rank_, first_of_rank_;  ///< on the first rank: rows of each rank
  std::int64_t local_rows_ = 0, rows_ = 0;
  double low_rank_ = 0;
  double sigma_ = 0;
  bool factored_ = false;
  std::int64_t below_ = 0;
};

/// Solves for the same right-hand sides in every team; each team solves for a part of the columns. The
/// factors of all teams have one shift. @return (local rows, n), the same in every team. Collective on all
/// ranks of `teams`.
Eigen::MatrixXd shared_solve(const parallel::Teams& teams, Factorisation& factor,
                             const Eigen::Ref<const Eigen::MatrixXd>& right);

/// XᵀY summed over the ranks, the same on each. Collective.
Eigen::MatrixXd inner(MPI_Comm comm, const Eigen::Ref<const Eigen::MatrixXd>& x,
                      const Eigen::Ref<const Eigen::MatrixXd>& y);

}  // namespace ricochet::modes
