// SPDX-License-Identifier: BSD-2-Clause
// Dense matrices and vectors of contact, as its lowest module knows them.
#pragma once

#include <Eigen/Dense>

namespace ricochet::contact {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Vector = Eigen::VectorXd;

}  // namespace ricochet::contact
