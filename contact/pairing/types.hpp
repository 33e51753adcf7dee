// SPDX-License-Identifier: BSD-2-Clause
// Types of dense matrices and vectors in all modules of contact.
#pragma once

#include <Eigen/Dense>

namespace ricochet::contact {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Vector = Eigen::VectorXd;

}  // namespace ricochet::contact
