// SPDX-License-Identifier: BSD-2-Clause
// Symmetric eigenvalue problems by the divide-and-conquer solver of LAPACK. From a few hundred rows on, the
// solver of Eigen takes several times as long.
#pragma once

#include <mpi.h>

#include <Eigen/Dense>

namespace ricochet::modes {

/// Returns the eigenvalues of a symmetric matrix in ascending order. Reads only the lower triangle, and
/// overwrites the matrix with the eigenvectors. Throws SolverError if the solver does not converge.
///
/// The first rank of `comm` computes them for all: on unlike processors, LAPACK rounds differently, and ranks
/// that decide by its results must not disagree. Collective; `matrix` has the same size on every rank.
Eigen::VectorXd eigen_decomposition(MPI_Comm comm, Eigen::MatrixXd& matrix);

/// Returns the eigenvalues θ of A x = θ B x in ascending order, with B positive definite. Reads only the
/// lower triangles, overwrites A with the eigenvectors, which are B-orthonormal, and destroys B. Throws
/// SolverError if B is not positive definite or the solver does not converge.
Eigen::VectorXd eigen_decomposition(Eigen::MatrixXd& a, Eigen::MatrixXd& b);

}  // namespace ricochet::modes
