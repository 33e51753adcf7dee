// SPDX-License-Identifier: BSD-2-Clause
// Linear functions of fields on the mesh.
#pragma once

#include <Eigen/SparseCore>
#include <cstdint>
#include <vector>

namespace ricochet::reduction {

/// Linear functions of the gradient at points, such as the stress. A point takes c values of each node, for
/// the components of the field:
///
///   y = L g,   g_(lc + k) = Σ weight_l u_k(node)   over the shares of the point, l = 0, 1, 2
struct GradientRows {
  std::vector<std::size_t> point{};    ///< (P) those that have shares on this rank, ascending
  std::vector<std::int64_t> start{0};  ///< (P + 1) their first shares
  std::vector<int> node{};             ///< (shares) owned by this rank, its local number
  std::vector<double> weight{};        ///< (shares,3) [1/m]
  Eigen::MatrixXd law{};               ///< (rows of a point, 3c P) L of each point
};

/// Linear functions of a field on the mesh, such as its values at some nodes.
struct Rows {
  Eigen::SparseMatrix<double, Eigen::RowMajor> of;  ///< (rows, local rows of the field), compressed
  GradientRows of_gradient;                         ///< further rows, by point
  Eigen::MatrixXd value;                            ///< (all rows, columns of the field) this rank's share

  Eigen::Index gradient_rows() const { return of_gradient.law.rows() * std::ssize(of_gradient.point); }
  /// Values of columns of a field (local rows, n) by `of`. Reads it once for 8 columns. @return (rows, n)
  Eigen::MatrixXd times(const Eigen::Ref<const Eigen::MatrixXd>& columns) const;
  /// The same by `of_gradient`.
  Eigen::MatrixXd gradient_times(const Eigen::Ref<const Eigen::MatrixXd>& columns) const;
  /// Both, one below the other.
  Eigen::MatrixXd all_times(const Eigen::Ref<const Eigen::MatrixXd>& columns) const;
};

}  // namespace ricochet::reduction
