// SPDX-License-Identifier: BSD-2-Clause
// The factor of a matrix J that changes by few rows and columns: the factor of an earlier J, and a border,
//
//   ⎡ J  B ⎤ ⎡x⎤   ⎡f⎤
//   ⎣ C  D ⎦ ⎣y⎦ = ⎣g⎦ ,     Σ = D − C Z,   Z = J⁻¹ B,   y = Σ⁻¹ (g − C J⁻¹ f),   x = J⁻¹ f − Z y
//
// A border of b rows and columns costs O(b n²) once and O(b n) in each solve; a new factor costs O(n³). Only
// the constructor allocates.
#pragma once

#include <Eigen/Dense>

#include "contact/complementarity/pivoted_factor.hpp"

namespace ricochet::contact {

class BorderedFactor {
 public:
  explicit BorderedFactor(int capacity);

  /// The matrix J to be factored, (n,n) with uninitialised entries. Removes the border.
  ReservedMatrix::View begin(int n) noexcept {
    size_ = n;
    border_ = 0;
    return factor_.begin(n);
  }
  void factor() noexcept { factor_.factor(); }

  int size() const { return size_; }      ///< n
  int border() const { return border_; }  ///< b
  /// Largest b for which the border is cheaper than a new factor.
  int most() const { return most(size_); }
  static int most(int n) { return 6 + n / 8; }

  /// Appends a column of B and a row of C, (n) zeros, and a row and a column of D, (b) zeros.
  void append() noexcept;
  double* column(int i) { return columns_.data() + i * stride_; }  ///< (n) of B, until `complete`
  double* row(int i) { return rows_.data() + i * stride_; }        ///< (n) of C
  double& corner(int i, int j) { return schur_[i + j * most_]; }   ///< of D, until `complete`
  /// Keeps only these border entries, in this order; `kept` ascends.
  void keep(const int* kept, int count) noexcept;
  /// Factors Σ. To be called after the border has changed. @param first  first entry that is new
  void complete(int first) noexcept;

  /// Replaces x (n) and y (b), on input f and g, by the solution. Returns false if a pivot is 0.
  bool solve(double* x, double* y) noexcept;
  /// Of the determinant of the whole matrix; 0 if a pivot is below `least`.
  int sign(double least) const {
    return border_ > 0 ? factor_.sign(least) * small_.sign(least) : factor_.sign(least);
  }

  void archive(auto& a) { a(size_, border_, factor_, small_, columns_, rows_, schur_); }

 private:
  std::ptrdiff_t stride_;
  int most_, size_ = 0, border_ = 0;
  PivotedFactor factor_, small_;  ///< of J, of Σ
  base::Reserved<double> columns_, rows_, schur_;
};

}  // namespace ricochet::contact
