// SPDX-License-Identifier: BSD-2-Clause
#include "src/reduction/rows.hpp"

#include <Eigen/Dense>
#include <algorithm>

namespace ricochet::reduction {

namespace {

using Eigen::Index;

/// Columns per pass over the rows; they fill one cache line.
constexpr int rows_width = 8;

using Beside = Eigen::Matrix<double, Eigen::Dynamic, rows_width, Eigen::RowMajor>;

/// y = A x for rows of A. Each row of x and y has `rows_width` columns side by side. Compiled for several
/// instruction sets, because packages of a distribution are built for the oldest one.
__attribute__((target_clones("arch=x86-64-v4", "avx2", "default"))) void apply(Index rows, const int* start,
                                                                               const int* column,
                                                                               const double* value,
                                                                               const double* x, double* y) {
  for (Index i = 0; i < rows; ++i) {
    double sum[rows_width] = {};
    for (int k = start[i]; k < start[i + 1]; ++k) {
      const double* xk = x + static_cast<Index>(column[k]) * rows_width;
      for (int w = 0; w < rows_width; ++w) sum[w] += value[k] * xk[w];
    }
    for (int w = 0; w < rows_width; ++w) y[i * rows_width + w] = sum[w];
  }
}

}  // namespace

Eigen::MatrixXd Rows::times(const Eigen::Ref<const Eigen::MatrixXd>& columns, Index first,
                            Index count) const {
  Eigen::MatrixXd out(count, columns.cols());
  Beside x = Beside::Zero(columns.rows(), rows_width), y(count, rows_width);
  for (Index from = 0; from < columns.cols(); from += rows_width) {
    const Index n = std::min<Index>(rows_width, columns.cols() - from);
    x.leftCols(n) = columns.middleCols(from, n);
    apply(count, of.outerIndexPtr() + first, of.innerIndexPtr(), of.valuePtr(), x.data(), y.data());
    out.middleCols(from, n) = y.leftCols(n);
  }
  return out;
}

}  // namespace ricochet::reduction
