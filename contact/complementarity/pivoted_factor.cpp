// SPDX-License-Identifier: BSD-2-Clause
#include "contact/complementarity/pivoted_factor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ricochet::contact {
namespace {

constexpr int width = 16;  // of a panel, which stays in the cache

}  // namespace

PivotedFactor::PivotedFactor(int capacity)
    : loops_(&simd::dense()), matrix_(capacity), exchange_(static_cast<std::size_t>(std::max(capacity, 1))) {}

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
      loops_->subtract_product(rest, rest, last - first, &A(last, first), size_, &A(first, last), size_,
                               &A(last, last), size_);
  }
}

bool PivotedFactor::solve(double* x) const noexcept {
  if (!(least_pivot_ > 0)) return false;
  const int n = size_;
  for (int c = 0; c < n; ++c) std::swap(x[c], x[exchange_[c]]);
  const double* const a = matrix_.view().data();
  const auto column = [&](int c) { return a + static_cast<std::ptrdiff_t>(c) * n; };
  // Four columns at once load and store x once. Each loop begins with the triangle of its four.
  const auto subtract = [&](int first, int from, int count) {
    const double* const four[] = {column(first) + from, column(first + 1) + from, column(first + 2) + from,
                                  column(first + 3) + from};
    loops_->subtract_columns(static_cast<std::size_t>(count), four, x + first, x + from);
  };
  int first = 0;
  for (; first + 4 <= n; first += 4) {
    for (int c = first; c < first + 3; ++c)
      for (int i = c + 1; i < first + 4; ++i) x[i] -= x[c] * column(c)[i];
    subtract(first, first + 4, n - first - 4);
  }
  for (int c = first; c < n; ++c)
    for (int i = c + 1; i < n; ++i) x[i] -= x[c] * column(c)[i];
  for (int c = n - 1; c >= first; --c) {
    x[c] /= column(c)[c];
    for (int i = 0; i < c; ++i) x[i] -= x[c] * column(c)[i];
  }
  for (first -= 4; first >= 0; first -= 4) {
    for (int c = first + 3; c >= first; --c) {
      x[c] /= column(c)[c];
      for (int i = first; i < c; ++i) x[i] -= x[c] * column(c)[i];
    }
    subtract(first, 0, first);
  }
  return true;
}

}  // namespace ricochet::contact
