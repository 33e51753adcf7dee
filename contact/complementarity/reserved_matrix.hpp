// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <Eigen/Dense>

#include "base/reserved.hpp"

namespace ricochet::contact {

/// A square matrix whose size may change without allocation. It uses memory only for its present size. Each
/// column begins at a cache line, as the loops over columns want it.
class ReservedMatrix {
 public:
  using View = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
  using ConstView = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

  /// @param capacity  largest number of rows
  explicit ReservedMatrix(Eigen::Index capacity = 0)
      : entries_(static_cast<std::size_t>(capacity * padded(capacity))) {}

  /// Sets the number of rows and columns. All entries are undefined afterwards.
  View begin(Eigen::Index rows) noexcept {
    rows_ = rows;
    stride_ = padded(rows);
    entries_.resize(static_cast<std::size_t>(rows * stride_));
    return view();
  }
  View view() noexcept { return {entries_.data(), rows_, rows_, Eigen::OuterStride<>(stride_)}; }
  ConstView view() const noexcept { return {entries_.data(), rows_, rows_, Eigen::OuterStride<>(stride_)}; }
  double* column(Eigen::Index j) noexcept { return entries_.data() + j * stride_; }
  const double* column(Eigen::Index j) const noexcept { return entries_.data() + j * stride_; }
  Eigen::Index stride() const { return stride_; }  ///< distance of columns

  void archive(auto& a) { a(rows_, stride_, entries_); }

 private:
  static Eigen::Index padded(Eigen::Index rows) {
    constexpr Eigen::Index line = 8;  // numbers
    return (rows + line - 1) / line * line;
  }

  base::Reserved<double> entries_;
  Eigen::Index rows_ = 0, stride_ = 0;
};

}  // namespace ricochet::contact
