// SPDX-License-Identifier: BSD-2-Clause
// Linear functions of fields on the mesh.
#pragma once

#include <Eigen/SparseCore>

namespace ricochet::reduction {

/// Linear functions of a field on the mesh, such as its values at some nodes.
struct Rows {
  Eigen::SparseMatrix<double, Eigen::RowMajor> of;  ///< (rows, local rows of the field), compressed
  Eigen::MatrixXd value;                            ///< (rows, columns of the field) this rank's share

  /// Values of columns of a field (local rows, n), for `count` of the rows from `first` on. Reads these rows
  /// once for 8 columns.
  /// @return (count, n)
  Eigen::MatrixXd times(const Eigen::Ref<const Eigen::MatrixXd>& columns, Eigen::Index first,
                        Eigen::Index count) const;
  Eigen::MatrixXd times(const Eigen::Ref<const Eigen::MatrixXd>& columns) const {
    return times(columns, 0, of.rows());
  }
};

}  // namespace ricochet::reduction
