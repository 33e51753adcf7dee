// SPDX-License-Identifier: BSD-2-Clause
#include "src/reduction/rows.hpp"

#include <Eigen/Dense>
#include <algorithm>

namespace ricochet::reduction {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

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

/// g of points, as in GradientRows, of fields with `c` components. Compiled as `apply`.
__attribute__((target_clones("arch=x86-64-v4", "avx2", "default"))) void gradients(
    Index points, const std::int64_t* start, const int* node, const double* weight, int c, const double* x,
    double* g) {
  for (Index p = 0; p < points; ++p)
    for (int k = 0; k < c; ++k) {
      double sum[3][rows_width] = {};
      for (std::int64_t s = start[p]; s < start[p + 1]; ++s) {
        const double* u = x + (static_cast<Index>(node[s]) * c + k) * rows_width;
        for (int l = 0; l < 3; ++l)
          for (int w = 0; w < rows_width; ++w) sum[l][w] += weight[3 * s + l] * u[w];
      }
      for (int l = 0; l < 3; ++l)
        for (int w = 0; w < rows_width; ++w) g[((3 * p + l) * c + k) * rows_width + w] = sum[l][w];
    }
}

/// Values of columns of a field. act(x, y) computes those of `rows_width` columns, which lie side by side.
template <class Act>
MatrixXd by_passes(const Eigen::Ref<const MatrixXd>& columns, Index rows, Act&& act) {
  MatrixXd out(rows, columns.cols());
  Beside x = Beside::Zero(columns.rows(), rows_width), y(rows, rows_width);
  for (Index from = 0; from < columns.cols(); from += rows_width) {
    const Index n = std::min<Index>(rows_width, columns.cols() - from);
    x.leftCols(n) = columns.middleCols(from, n);
    act(x, y);
    out.middleCols(from, n) = y.leftCols(n);
  }
  return out;
}

}  // namespace

MatrixXd Rows::times(const Eigen::Ref<const MatrixXd>& columns) const {
  return by_passes(columns, of.rows(), [&](const Beside& x, Beside& y) {
    apply(of.rows(), of.outerIndexPtr(), of.innerIndexPtr(), of.valuePtr(), x.data(), y.data());
  });
}

MatrixXd Rows::gradient_times(const Eigen::Ref<const MatrixXd>& columns) const {
  const GradientRows& to = of_gradient;
  const Index points = std::ssize(to.point), n = to.law.rows();
  if (points == 0) return MatrixXd(0, columns.cols());
  const Index width = to.law.cols() / points;
  Beside g(points * width, rows_width);
  return by_passes(columns, points * n, [&](const Beside& x, Beside& y) {
    gradients(points, to.start.data(), to.node.data(), to.weight.data(), static_cast<int>(width / 3),
              x.data(), g.data());
    for (Index p = 0; p < points; ++p)
      y.middleRows(p * n, n).noalias() = to.law.middleCols(p * width, width) * g.middleRows(p * width, width);
  });
}

MatrixXd Rows::all_times(const Eigen::Ref<const MatrixXd>& columns) const {
  MatrixXd out(of.rows() + gradient_rows(), columns.cols());
  out << times(columns), gradient_times(columns);
  return out;
}

}  // namespace ricochet::reduction
