// SPDX-License-Identifier: BSD-2-Clause
#include "contact/complementarity/pivoted_factor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ricochet::contact {
namespace {

constexpr int width = 16;  // of a panel; narrow enough that Eigen keeps the
                           // buffers of a product on the stack

}  // namespace

PivotedFactor::PivotedFactor(int capacity)
    : matrix_(capacity), exchange_(static_cast<std::size_t>(std::max(capacity, 1))) {}

/// Factors columns first … last − 1, which hold the Schur complement, and exchanges whole rows.
void PivotedFactor::factor_panel(int first, int last) noexcept {
  const int n = size_;
  double* const a = matrix_.view().data();
  for (int c = first; c < last; ++c) {
    double* const column = a + static_cast<std::ptrdiff_t>(c) * n;
    int pivot = c;
    for (int i = c + 1; i < n; ++i)
      if (std::abs(column[i]) > std::abs(column[pivot])) pivot = i;
    exchange_[c] = pivot;
    if (pivot != c) {
      for (int k = 0; k < n; ++k) {
        double* const row = a + static_cast<std::ptrdiff_t>(k) * n;
        std::swap(row[c], row[pivot]);
      }
      sign_ = -sign_;
    }
    if (column[c] < 0) sign_ = -sign_;
    least_pivot_ = std::min(least_pivot_, std::abs(column[c]));
    if (column[c] == 0) continue;
    const double inverse = 1 / column[c];
    for (int i = c + 1; i < n; ++i) column[i] *= inverse;
    for (int k = c + 1; k < last; ++k) {
      double* const other = a + static_cast<std::ptrdiff_t>(k) * n;
      const double factor = other[c];
      if (factor == 0) continue;
#pragma GCC ivdep
      for (int i = c + 1; i < n; ++i) other[i] -= factor * column[i];
    }
  }
}

void PivotedFactor::factor() noexcept {
  sign_ = 1;
  least_pivot_ = std::numeric_limits<double>::infinity();
  auto A = matrix_.view();
  if (size_ <= 2 * width) return factor_panel(0, size_);
  for (int first = 0; first < size_; first += width) {
    const int last = std::min(first + width, size_), rest = size_ - last;
    factor_panel(first, last);
    for (int k = last; k < size_; ++k)  // L₁₁⁻¹ A₁₂
      for (int c = first; c < last; ++c) {
        const double factor = A(c, k);
        for (int i = c + 1; i < last; ++i) A(i, k) -= factor * A(i, c);
      }
    if (rest > 0)
      A.bottomRightCorner(rest, rest).noalias() -=
          A.block(last, first, rest, last - first) * A.block(first, last, last - first, rest);
  }
}

bool PivotedFactor::solve(double* x) const noexcept {
  if (!(least_pivot_ > 0)) return false;
  const int n = size_;
  for (int c = 0; c < n; ++c) std::swap(x[c], x[exchange_[c]]);
  const double* const a = matrix_.view().data();
  const auto column = [&](int c) { return a + static_cast<std::ptrdiff_t>(c) * n; };
  // Four columns at once load and store x once.
  int first = 0;
  for (; first + 4 <= n; first += 4) {
    const double *const a0 = column(first), *const a1 = column(first + 1), *const a2 = column(first + 2),
                        *const a3 = column(first + 3);
    double* const y = x + first;
    y[1] -= a0[first + 1] * y[0];
    y[2] -= a0[first + 2] * y[0] + a1[first + 2] * y[1];
    y[3] -= a0[first + 3] * y[0] + a1[first + 3] * y[1] + a2[first + 3] * y[2];
    const double y0 = y[0], y1 = y[1], y2 = y[2], y3 = y[3];
#pragma GCC ivdep
    for (int i = first + 4; i < n; ++i) x[i] -= (y0 * a0[i] + y1 * a1[i]) + (y2 * a2[i] + y3 * a3[i]);
  }
  for (int c = first; c < n; ++c)
    for (int i = c + 1; i < n; ++i) x[i] -= x[c] * column(c)[i];
  for (int c = n - 1; c >= first; --c) {
    x[c] /= column(c)[c];
    for (int i = 0; i < c; ++i) x[i] -= x[c] * column(c)[i];
  }
  for (first -= 4; first >= 0; first -= 4) {
    const double *const a0 = column(first), *const a1 = column(first + 1), *const a2 = column(first + 2),
                        *const a3 = column(first + 3);
    double* const y = x + first;
    y[3] /= a3[first + 3];
    y[2] = (y[2] - a3[first + 2] * y[3]) / a2[first + 2];
    y[1] = (y[1] - a3[first + 1] * y[3] - a2[first + 1] * y[2]) / a1[first + 1];
    y[0] = (y[0] - a3[first] * y[3] - a2[first] * y[2] - a1[first] * y[1]) / a0[first];
    const double y0 = y[0], y1 = y[1], y2 = y[2], y3 = y[3];
#pragma GCC ivdep
    for (int i = 0; i < first; ++i) x[i] -= (y0 * a0[i] + y1 * a1[i]) + (y2 * a2[i] + y3 * a3[i]);
  }
  return true;
}

}  // namespace ricochet::contact
