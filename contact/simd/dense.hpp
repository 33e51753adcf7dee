// SPDX-License-Identifier: BSD-2-Clause
// Loops over dense matrices, stored by columns, compiled once for each instruction set and chosen at run
// time. Eigen knows only the instructions that every processor has. They do not allocate, lock or call other
// functions.
#pragma once

#include <cstddef>

namespace ricochet::contact::simd {

/// A point of a body: the mean displacement of up to three candidates and of its frame, along its rows.
struct Lever {
  double row[3][4];         ///< the directions of its rows, in the axes of the body; the fourth entry is 0
  double arm[3];            ///< from the centre of the body, in its axes
  double weight[3];         ///< of its candidates
  std::size_t at[3];        ///< their places among those of the body
  std::size_t count;        ///< of them
  std::size_t first, rows;  ///< its rows in the matrix of all points: 1, or 3
};

/// How a body yields to forces, in its axes.
struct Yield {
  /// M and R of candidates, three rows and columns of each; R may be null. Columns begin at cache lines, up
  /// to the next of which they are read.
  const double *M, *R;
  std::size_t stride;  ///< distance of columns
  double share;        ///< a, by which M is multiplied
  double shift;        ///< of the frame under a unit force, times a
  double turn[3][3];   ///< of the frame under a unit moment, times a
};

/// A lever among others, and its first row in a vector of rows.
struct Pull {
  std::size_t lever, row;
};

/// Constants of modes in a step, and constant loads on them.
struct Oscillators {
  const double *b, *c, *e, *h, *stiffness, *damp_ss, *damp_sr, *damp_rr, *load, *applied;
};

struct Dense {
  /// C (m,n) −= A (m,k) B (k,n), with the distances of their columns.
  void (*subtract_product)(std::size_t m, std::size_t n, std::size_t k, const double* A, std::size_t of_A,
                           const double* B, std::size_t of_B, double* C, std::size_t of_C);
  /// P A = L U of a matrix (rows, columns) with at most as many columns, which begin at multiples of 8
  /// numbers, up to the next of which they may be spoilt. @param exchange  (columns) row that was exchanged
  void (*factor_panel)(std::size_t rows, std::size_t columns, double* A, std::size_t of_A, int* exchange);
  /// B (rows, columns) = L⁻¹ B of at most 8 rows, of a unit lower triangle; likewise.
  void (*solve_lower)(std::size_t rows, std::size_t columns, const double* L, std::size_t of_L, double* B,
                      std::size_t of_B);
  /// Inverts the blocks of 8 rows on the diagonals of L and of U (n/8 rounded up,2,8,8), by columns.
  void (*invert_blocks)(std::size_t n, const double* LU, std::size_t of_LU, double* inverse);
  /// y (n) += A x of a symmetric matrix, of which only the entries on and below the diagonal are read.
  void (*symmetric_product)(std::size_t n, const double* A, std::size_t of_A, const double* x, double* y);
  /// ‖A‖_∞ of a symmetric matrix (n,n).
  double (*norm)(std::size_t n, const double* A, std::size_t of_A);
  /// x (n) −= Σ_k factor_k column_k of four columns.
  void (*subtract_columns)(std::size_t n, const double* const* column, const double* factor, double* x);
  /// x (n) = (L Lᵀ)⁻¹ x of a lower triangle L. Faster than blocked solvers for some tens of rows.
  /// @param reciprocal  (n) of the diagonal of L
  void (*solve_factor)(std::size_t n, const double* L, std::size_t of_L, const double* reciprocal, double* x);
  /// y (n) = U⁻¹ L⁻¹ y of factors in one matrix; likewise.
  /// @param inverse  from invert_blocks  @param x  (n + 7) scratch
  void (*solve_factors)(std::size_t n, const double* LU, std::size_t of_LU, const double* inverse, double* y,
                        double* x);
  /// y_k = row_k · x of rows (n), a multiple of three of them, with their distance.
  void (*row_products)(std::size_t rows, std::size_t n, const double* A, std::size_t of_A, const double* x,
                       double* y);
  /// The same for two vectors x, which reads the rows once.
  void (*two_row_products)(std::size_t rows, std::size_t n, const double* A, std::size_t of_A,
                           const double* const* x, double* const* y);
  /// x (n) += Σ_k y_k row_k of the same.
  void (*add_rows)(std::size_t rows, std::size_t n, const double* A, std::size_t of_A, const double* y,
                   double* x);
  /// Δq (n) of modes without forces: b q̇ + c (load − stiffness q).
  void (*free_motion)(std::size_t n, const Oscillators& of, const double* q, const double* v, double* dq);
  /// A step of modes (n) under forces: g = load + push − stiffness q, Δq = b q̇ + c g, q̇⁺ = e q̇ + h g. Adds
  /// the work of damping and Σ applied Δq to work (2).
  void (*move_modes)(std::size_t n, const Oscillators& of, const double* push, const double* q,
                     const double* v, double* next_q, double* next_v, double* work);
  /// Adds ½ Σ (v + lift)², ½ Σ stiffness q² and Σ load (q − origin) of modes (n) to energy (3).
  void (*add_energy)(std::size_t n, const double* stiffness, const double* load, const double* origin,
                     const double* lift, const double* q, const double* v, double* energy);
  /// Adds to rows of `out` (n,4), or sets there, the displacements of levers under unit forces along the rows
  /// of the first one, in columns 0, 1, 2: a M + R.
  /// @param from, to  places among which those of the levers are  @param u  (7, 3 to, rounded up to a
  /// multiple of 8) scratch
  void (*displace)(const Yield& body, const Lever* levers, std::size_t count, std::size_t from,
                   std::size_t to, double* u, bool adds, double* out);
  /// Sets the columns `first` and on, 1 or 3, of a symmetric matrix (n,n) and the rows across from them to
  /// what `displace` gave, on and below the diagonal.
  void (*spread)(std::size_t n, std::size_t first, std::size_t columns, const double* out, double* A,
                 std::size_t of_A);
  /// Adds to y the displacements of levers under forces p along their rows: R p of one body.
  /// @param R  of its candidates, three rows and columns of each  @param scratch  (6 candidates + 16)
  void (*yield)(std::size_t candidates, const double* R, std::size_t of_R, const Lever* levers,
                const Pull* pulls, std::size_t count, const double* p, double* scratch, double* y);
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
