// SPDX-License-Identifier: BSD-2-Clause
// Symmetric eigenvalue problems by the divide-and-conquer solver of LAPACK. From a few hundred rows on, the
// solver of Eigen takes several times as long.
#pragma once

#include <Eigen/Dense>

namespace ricochet::modes {

/// Returns the eigenvalues of a symmetric matrix in ascending order. Reads only the lower triangle, and
/// overwrites the matrix with the eigenvectors. Throws SolverError if the solver does not converge.
Eigen::VectorXd eigen_decomposition(Eigen::MatrixXd& matrix);

}  // namespace ricochet::modes
