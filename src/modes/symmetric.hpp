// SPDX-License-Identifier: BSD-2-Clause
// Symmetric eigenvalue problems by LAPACK's divide and conquer: from a few hundred rows on, Eigen's solver
// takes several times as long.
#pragma once

#include <Eigen/Dense>

namespace ricochet::modes {

/// Eigenvalues of a symmetric matrix, ascending. Its lower triangle is read, and it is overwritten by the
/// eigenvectors. Throws SolverError.
Eigen::VectorXd eigen_decomposition(Eigen::MatrixXd& matrix);

}  // namespace ricochet::modes
