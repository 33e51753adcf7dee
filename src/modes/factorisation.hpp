// K − σM factored by MUMPS: inertia and block solves.
#pragma once

#include <Eigen/Dense>

#include "src/parallel/parallel.hpp"

namespace ricochet::modes {

/// L D Lᵀ of K − σM, full rank, so that its inertia is a proof.
class Factorisation {
 public:
  /// Collective. @param sigma  [rad²/s²]. Throws SolverError when MUMPS breaks down.
  Factorisation(Mat stiffness, Mat mass, double sigma);

  /// Eigenvalues below σ (Sylvester's law of inertia).
  std::int64_t below() const { return below_; }

  /// Solves (K − σM) X = B. @param B (local rows, n), @return likewise. Collective.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;

 private:
  parallel::Matrix shifted_, factor_;
  std::int64_t below_ = 0;
};

/// Options every MUMPS factor of ours carries: no ScaLAPACK at the root, which would hide part of the
/// inertia.
void require_inertia(Mat factor);

/// A X for the columns of X (local rows, n). Collective.
Eigen::MatrixXd multiply(Mat matrix, const Eigen::MatrixXd& columns);

/// XᵀY summed over the ranks, the same on each. Collective.
Eigen::MatrixXd inner(MPI_Comm comm, const Eigen::MatrixXd& x, const Eigen::MatrixXd& y);

}  // namespace ricochet::modes
