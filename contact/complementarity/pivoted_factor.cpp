// SPDX-License-Identifier: BSD-2-Clause
#include "contact/complementarity/pivoted_factor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ricochet::contact {
namespace {

// Columns that are eliminated together: a product with `most_columns` reads them from the cache, and
// `fewest_columns`, or a small matrix, are too few for one.
constexpr int most_columns = 64, fewest_columns = 8, small_matrix = 32;

/// About half of a block, a whole number of registers.
int half(int columns) { return (columns + 2 * fewest_columns - 1) / (2 * fewest_columns) * fewest_columns; }

}  // namespace

PivotedFactor::PivotedFactor(int capacity)
    : loops_(&simd::dense()),
      matrix_(capacity),
      exchange_(static_cast<std::size_t>(std::max(capacity, 1))),
      inverse_((exchange_.size() + 7) / 8 * 128),
      work_(exchange_.size() + 7) {}

/// Factors columns first … last − 1, which hold the Schur complement, one by one.
void PivotedFactor::factor_one_by_one(int first, int last) noexcept {
  loops_->factor_panel(size_ - first, last - first, matrix_.column(first) + first,
                       static_cast<std::size_t>(matrix_.stride()), &exchange_[first]);
  for (int c = first; c < last; ++c) {
    const double pivot = matrix_.column(c)[c];
    exchange_[c] += first;
    if ((exchange_[c] != c) != (pivot < 0)) sign_ = -sign_;
    least_pivot_ = std::min(least_pivot_, std::abs(pivot));
  }
}

/// Makes the exchanges of the rows first … last − 1 in the columns from … to − 1.
void PivotedFactor::exchange_rows(int first, int last, int from, int to) noexcept {
  for (int c = first; c < last; ++c) {
    const int other = exchange_[c];
    if (other == c) continue;
    double *x = matrix_.column(from) + c, *y = matrix_.column(from) + other;
    for (int k = from; k < to; ++k, x += matrix_.stride(), y += matrix_.stride()) std::swap(*x, *y);
  }
}

/// Replaces the rows first … last − 1 of the columns from … to − 1 by L⁻¹ times them.
void PivotedFactor::solve_lower(int first, int last, int from, int to) noexcept {
  if (last - first > fewest_columns) {
    const int middle = first + half(last - first);
    solve_lower(first, middle, from, to);
    subtract_product(first, middle, last, from, to);
    return solve_lower(middle, last, from, to);
  }
  const auto stride = static_cast<std::size_t>(matrix_.stride());
  loops_->solve_lower(last - first, to - from, matrix_.column(first) + first, stride,
                      matrix_.column(from) + first, stride);
}

/// Subtracts from the rows middle … last − 1 of the columns from … to − 1 the product of L with the rows
/// first … middle − 1.
void PivotedFactor::subtract_product(int first, int middle, int last, int from, int to) noexcept {
  if (middle == last || from == to) return;
  auto A = matrix_.view();
  const auto stride = static_cast<std::size_t>(matrix_.stride());
  loops_->subtract_product(last - middle, to - from, middle - first, &A(middle, first), stride,
                           &A(first, from), stride, &A(middle, from), stride);
}

/// Factors columns first … last − 1, which hold the Schur complement, by products of blocks (Toledo 1997).
void PivotedFactor::factor_columns(int first, int last) noexcept {
  if (last - first <= fewest_columns || size_ <= small_matrix) return factor_one_by_one(first, last);
  const int middle = first + std::min(most_columns, half(last - first));
  factor_columns(first, middle);
  exchange_rows(first, middle, middle, last);
  solve_lower(first, middle, middle, last);
  subtract_product(first, middle, size_, middle, last);
  factor_columns(middle, last);
  exchange_rows(middle, last, first, middle);
}

void PivotedFactor::factor() noexcept {
  sign_ = 1;
  least_pivot_ = std::numeric_limits<double>::infinity();
  factor_columns(0, size_);
  if (!(least_pivot_ > 0)) return;  // solve refuses
  loops_->invert_blocks(static_cast<std::size_t>(size_), matrix_.column(0),
                        static_cast<std::size_t>(matrix_.stride()), inverse_.data());
}

bool PivotedFactor::solve(double* x) noexcept {
  if (!(least_pivot_ > 0)) return false;
  if (size_ == 0) return true;
  for (int c = 0; c < size_; ++c) std::swap(x[c], x[exchange_[c]]);
  loops_->solve_factors(static_cast<std::size_t>(size_), matrix_.column(0),
                        static_cast<std::size_t>(matrix_.stride()), inverse_.data(), x, work_.data());
  return true;
}

}  // namespace ricochet::contact
