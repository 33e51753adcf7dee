// SPDX-License-Identifier: BSD-2-Clause
// LAPACK's divide and conquer: Eigen's solver takes several times as long from a few hundred rows on.
#pragma once

#include <Eigen/Dense>

namespace ricochet::modes {

/// Eigenvalues of a symmetric matrix, ascending, given by its lower triangle and overwritten by its
/// eigenvectors. Throws SolverError.
Eigen::VectorXd eigen_decomposition(Eigen::MatrixXd& matrix);

}  // namespace ricochet::modes
