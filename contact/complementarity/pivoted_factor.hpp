// SPDX-License-Identifier: BSD-2-Clause
// P A = L U of a square matrix with row exchanges, by blocks. Only the constructor allocates.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "contact/complementarity/reserved_matrix.hpp"
#include "contact/simd/dense.hpp"

namespace ricochet::contact {

class PivotedFactor {
 public:
  explicit PivotedFactor(int capacity);

  /// The matrix to be factored, (n,n) with uninitialised entries.
  ReservedMatrix::View begin(int n) noexcept {
    size_ = n;
    return matrix_.begin(n);
  }
  void factor() noexcept;
  /// Replaces x (n) by A⁻¹ x. Returns false if a pivot is 0.
  bool solve(double* x) noexcept;
  /// Sign of det A; 0 if a pivot is below `least`.
  int sign(double least) const { return least_pivot_ < least ? 0 : sign_; }

  void archive(auto& a) { a(matrix_, exchange_, inverse_, work_, size_, sign_, least_pivot_); }

 private:
  void factor_columns(int first, int last) noexcept;
  void factor_one_by_one(int first, int last) noexcept;
  void exchange_rows(int first, int last, int from, int to) noexcept;
  void solve_lower(int first, int last, int from, int to) noexcept;
  void subtract_product(int first, int middle, int last, int from, int to) noexcept;

  const simd::Dense* loops_;
  ReservedMatrix matrix_;
  std::vector<int> exchange_;
  std::vector<double> inverse_, work_;  ///< of blocks on the diagonals; scratch
  int size_ = 0, sign_ = 1;
  double least_pivot_ = 0;
};

}  // namespace ricochet::contact
