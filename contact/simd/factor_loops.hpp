// SPDX-License-Identifier: BSD-2-Clause
// Loops over the factors L and U of a matrix in one matrix, whose columns begin at cache lines, by blocks of
// eight rows. Included by dense_loops.cpp alone, with the restrictions of lanes.hpp.
#pragma once

#include "contact/simd/lanes.hpp"

namespace ricochet::contact::simd {
namespace {

using V = Lanes<double>;
using Eight = Lanes<double, 8>;
constexpr std::size_t side = Eight::size;

/// x without the lanes before one.
template <std::size_t... j>
V::type from_lane(std::ptrdiff_t lane, V::type x, std::index_sequence<j...>) {
  return V::type{(static_cast<std::ptrdiff_t>(j) < lane ? 0 : x[j])...};
}

/// The row below c, or c itself, with the first largest entry.
std::size_t pivot_of(std::size_t rows, std::size_t c, const double* column) {
  V::type most = {};
  std::size_t i = c;
  for (; i + V::size <= rows; i += V::size) {
    const auto size = V::magnitude(V::load(column + i));
    most = size > most ? size : most;
  }
  double largest = 0;
  for (std::size_t k = 0; k < V::size; ++k) largest = most[k] > largest ? most[k] : largest;
  for (; i < rows; ++i) {
    const double size = column[i] < 0 ? -column[i] : column[i];
    largest = size > largest ? size : largest;
  }
  for (i = c; i < rows; ++i)
    if (column[i] == largest || column[i] == -largest) return i;
  return c;
}

void factor_panel(std::size_t rows, std::size_t columns, double* A, std::size_t of_A, int* exchange) {
  for (std::size_t c = 0; c < columns; ++c) {
    double* const column = A + c * of_A;
    const std::size_t pivot = pivot_of(rows, c, column), whole = c / V::size * V::size;
    exchange[c] = static_cast<int>(pivot);
    for (std::size_t k = 0; pivot != c && k < columns; ++k) std::swap(A[k * of_A + c], A[k * of_A + pivot]);
    if (column[c] == 0) continue;
    const double inverse = 1 / column[c];
    std::size_t below = c + 1;
    for (; below + V::size <= rows; below += V::size)
      V::store(column + below, inverse * V::load(column + below));
    for (; below < rows; ++below) column[below] *= inverse;
    const auto first = from_lane(static_cast<std::ptrdiff_t>(c + 1 - whole), V::load(column + whole),
                                 std::make_index_sequence<V::size>());
    for (std::size_t k = c + 1; k < columns; ++k) {
      double* const other = A + k * of_A;
      const double factor = other[c];
      V::store(other + whole, V::load(other + whole) - factor * first);
      for (std::size_t i = whole + V::size; i < rows; i += V::size)
        V::store(other + i, V::load(other + i) - factor * V::load(column + i));
    }
  }
}

template <std::size_t c>
Eight::type in_all(Eight::type x) {
  return __builtin_shufflevector(x, x, c, c, c, c, c, c, c, c);
}

/// The columns of a unit lower triangle of at most 8 rows, without its diagonal.
struct Lower {
  Lower(std::size_t size, const double* L, std::size_t of_L) : rows(size) {
    for (std::size_t c = 0; c < rows; ++c)
      for (std::size_t i = c + 1; i < rows; ++i) column[c][i] = L[c * of_L + i];
  }
  /// Solves for vectors that do not wait for one another.
  template <std::size_t count, std::size_t... c>
  void solve(Eight::type (&x)[count], std::index_sequence<c...>) const {
    const auto eliminate = [&]<std::size_t row>(std::integral_constant<std::size_t, row>) {
      for (std::size_t j = 0; row + 1 < rows && j < count; ++j) x[j] -= in_all<row>(x[j]) * column[row];
    };
    (eliminate(std::integral_constant<std::size_t, c>()), ...);
  }
  template <std::size_t count>
  void solve(Eight::type (&x)[count]) const {
    solve(x, std::make_index_sequence<side - 1>());
  }

  std::size_t rows;
  Eight::type column[side] = {};
};

/// The same of an upper triangle.
struct Upper {
  Upper(std::size_t size, const double* U, std::size_t of_U) : rows(size) {
    for (std::size_t c = 0; c < rows; ++c) {
      for (std::size_t i = 0; i < c; ++i) column[c][i] = U[c * of_U + i];
      inverse[c] = 1 / U[c * of_U + c];
    }
  }
  template <std::size_t count, std::size_t... c>
  void solve(Eight::type (&x)[count], std::index_sequence<c...>) const {
    const auto eliminate = [&]<std::size_t row>(std::integral_constant<std::size_t, row>) {
      for (std::size_t j = 0; row < rows && j < count; ++j) {
        const auto value = in_all<row>(x[j]) * inverse[row];
        x[j] -= value * column[row];
        x[j][row] = value[row];
      }
    };
    (eliminate(std::integral_constant<std::size_t, side - 1 - c>()), ...);
  }
  template <std::size_t count>
  void solve(Eight::type (&x)[count]) const {
    solve(x, std::make_index_sequence<side>());
  }

  std::size_t rows;
  Eight::type column[side] = {};
  double inverse[side] = {};
};

void solve_lower(std::size_t rows, std::size_t columns, const double* L, std::size_t of_L, double* B,
                 std::size_t of_B) {
  const Lower lower(rows, L, of_L);
  constexpr std::size_t together = 4;
  for (std::size_t k = 0; k < columns; k += together) {
    const std::size_t count = columns - k < together ? columns - k : together;
    Eight::type x[together];
    for (std::size_t j = 0; j < together; ++j) x[j] = Eight::load(B + (k + (j < count ? j : 0)) * of_B);
    lower.solve(x);
    for (std::size_t j = 0; j < count; ++j) Eight::store(B + (k + j) * of_B, x[j]);
  }
}

void invert_blocks(std::size_t n, const double* LU, std::size_t of_LU, double* inverse) {
  for (std::size_t first = 0; first < n; first += side, inverse += 2 * side * side) {
    const std::size_t rows = n - first < side ? n - first : side;
    const double* const at = LU + first * of_LU + first;
    Eight::type x[side] = {}, y[side] = {};
    for (std::size_t j = 0; j < rows; ++j) x[j][j] = y[j][j] = 1;
    Lower(rows, at, of_LU).solve(x);
    Upper(rows, at, of_LU).solve(y);
    for (std::size_t j = 0; j < side; ++j) {
      Eight::store(inverse + j * side, x[j]);
      Eight::store(inverse + (side + j) * side, y[j]);
    }
  }
}

/// x (8) = A x
void multiply_block(const double* A, double* x) {
  Eight::type even = {}, odd = {};
  for (std::size_t c = 0; c < side; c += 2) {
    even += x[c] * Eight::load(A + c * side);
    odd += x[c + 1] * Eight::load(A + (c + 1) * side);
  }
  Eight::store(x, even + odd);
}

void solve_factors(std::size_t n, const double* LU, std::size_t of_LU, const double* inverse, double* y,
                   double* x) {
  const std::size_t whole = (n + side - 1) / side * side;
  const auto subtract = [&](std::size_t first, std::size_t from, std::size_t to) {
    const double* column[side];
    double factor[side];
    for (std::size_t c = 0; c < side; ++c) {
      const bool exists = first + c < n;
      column[c] = LU + (exists ? first + c : first) * of_LU;
      factor[c] = exists ? x[first + c] : 0;
    }
    for (std::size_t i = from; i < to; i += side) {
      auto even = Eight::load(x + i);
      Eight::type odd = {};
      for (std::size_t c = 0; c < side; c += 2) {
        even -= factor[c] * Eight::load(column[c] + i);
        odd += factor[c + 1] * Eight::load(column[c + 1] + i);
      }
      Eight::store(x + i, even - odd);
    }
  };
  for (std::size_t i = 0; i < n; ++i) x[i] = y[i];
  for (std::size_t first = 0; first < n; first += side) {
    for (std::size_t i = n; i < first + side; ++i) x[i] = 0;  // spoilt by what is below L
    multiply_block(inverse + 2 * side * first, x + first);
    subtract(first, first + side, whole);
  }
  for (std::size_t first = whole; first > 0;) {
    first -= side;
    multiply_block(inverse + 2 * side * first + side * side, x + first);
    subtract(first, 0, first);
  }
  for (std::size_t i = 0; i < n; ++i) y[i] = x[i];
}

}  // namespace
}  // namespace ricochet::contact::simd
