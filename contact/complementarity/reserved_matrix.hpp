// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <Eigen/Dense>

#include "base/reserved.hpp"

namespace ricochet::contact {

/// A square matrix whose size may change without allocation. It uses memory only for its present size.
class ReservedMatrix {
 public:
  /// @param capacity  largest number of rows
  explicit ReservedMatrix(Eigen::Index capacity = 0)
      : entries_(static_cast<std::size_t>(capacity) * static_cast<std::size_t>(capacity)) {}

  /// Sets the number of rows and columns. All entries are undefined afterwards.
  Eigen::Map<Eigen::MatrixXd> begin(Eigen::Index rows) noexcept {
    rows_ = rows;
    entries_.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(rows));
    return {entries_.data(), rows, rows};
  }
  Eigen::Map<Eigen::MatrixXd> view() noexcept { return {entries_.data(), rows_, rows_}; }
  Eigen::Map<const Eigen::MatrixXd> view() const noexcept { return {entries_.data(), rows_, rows_}; }

 private:
  base::Reserved<double> entries_;
  Eigen::Index rows_ = 0;
};

}  // namespace ricochet::contact
