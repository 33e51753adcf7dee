// SPDX-License-Identifier: BSD-2-Clause
// Loops over dense matrices, stored by columns, compiled once for each instruction set and chosen at run
// time. Eigen knows only the instructions that every processor has. They do not allocate, lock or call other
// functions.
#pragma once

#include <cstddef>

namespace ricochet::contact::simd {

/// A point of a body: the mean displacement of up to three candidates and of its frame, along three
/// directions.
struct Lever {
  double direction[3][4];   ///< columns of the directions (3,3) in body axes; the last entries are 0
  double moment[3][4];      ///< the same of −D r̂, with the arm r of the point
  double weight[3];         ///< of its candidates
  std::size_t at[3];        ///< first row of each among the rows of all candidates
  std::size_t count;        ///< of candidates
  std::size_t first, rows;  ///< its rows in the matrix of all points: 1, or 3
};

struct Dense {
  /// C (m,n) −= A (m,k) B (k,n), with the distances of their columns.
  void (*subtract_product)(std::size_t m, std::size_t n, std::size_t k, const double* A, std::size_t of_A,
                           const double* B, std::size_t of_B, double* C, std::size_t of_C);
  /// y (n) += A x of a symmetric matrix, of which only the entries on and below the diagonal are read.
  void (*symmetric_product)(std::size_t n, const double* A, std::size_t of_A, const double* x, double* y);
  /// x (n) −= Σ_k factor_k column_k of four columns.
  void (*subtract_columns)(std::size_t n, const double* const* column, const double* factor, double* x);
  /// x (n) = (L Lᵀ)⁻¹ x of a lower triangle L. Faster than blocked solvers for some tens of rows.
  /// @param reciprocal  (n) of the diagonal of L
  void (*solve_factor)(std::size_t n, const double* L, std::size_t of_L, const double* reciprocal, double* x);
  /// y_k = row_k · x of three rows (n).
  void (*three_products)(std::size_t n, const double* const* row, const double* x, double* y);
  /// Adds to the columns of the first lever, in its rows and below, the displacements of the levers: to A
  /// those of candidates (of_u,3), u, and of the frame, D (shift + θ × r) with shift (3,3) and θ = turn
  /// (3,3); to B those of candidates v, unless v is null. One number beyond each column of u and v is read.
  void (*displace)(const Lever* levers, std::size_t count, const double* u, const double* v, std::size_t of_u,
                   const double* shift, const double* turn, double* A, double* B, std::size_t of_A);
};

/// Of this processor.
const Dense& dense() noexcept;

/// Subtracts multiples of columns (n) from x, four at a time.
class ColumnSum {
 public:
  ColumnSum(std::size_t n, double* x) noexcept : loops_(dense()), n_(n), x_(x) {}
  ~ColumnSum() {
    for (std::size_t k = count_; k < together && count_ > 0; ++k) {
      column_[k] = column_[0];
      factor_[k] = 0;
    }
    if (count_ > 0) loops_.subtract_columns(n_, column_, factor_, x_);
  }
  ColumnSum(const ColumnSum&) = delete;
  ColumnSum& operator=(const ColumnSum&) = delete;

  void subtract(const double* column, double factor) noexcept {
    column_[count_] = column;
    factor_[count_] = factor;
    if (++count_ < together) return;
    loops_.subtract_columns(n_, column_, factor_, x_);
    count_ = 0;
  }

 private:
  static constexpr std::size_t together = 4;
  const Dense& loops_;
  std::size_t n_, count_ = 0;
  double* x_;
  const double* column_[together];
  double factor_[together];
};

/// y (n) += A x of a symmetric matrix with both triangles.
inline void add_product(std::size_t n, const double* A, std::size_t of_A, const double* x,
                        double* y) noexcept {
  constexpr std::size_t in_cache = 128;  // rows up to which columns come faster than one triangle's sums
  std::size_t used = 0;
  for (std::size_t i = 0; i < n; ++i) used += x[i] != 0 ? 1 : 0;
  if (n > in_cache && 2 * used > n) return dense().symmetric_product(n, A, of_A, x, y);
  ColumnSum sum(n, y);
  for (std::size_t i = 0; i < n; ++i)
    if (x[i] != 0) sum.subtract(A + i * of_A, -x[i]);
}

}  // namespace ricochet::contact::simd
