// SPDX-License-Identifier: BSD-2-Clause
// The active set P of a complementarity problem with the Cholesky factor of S_PP, which is updated as indices
// enter and leave. Only the constructor allocates.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/reserved.hpp"

namespace ricochet::contact {

/// S (n,n), symmetric positive semidefinite, both triangles.
using Symmetric = Eigen::Ref<const Eigen::MatrixXd>;

/// Largest |x_k| of the first n values.
inline double largest_of(const std::vector<double>& x, int n) {
  double largest = 0;
  for (int k = 0; k < n; ++k) largest = std::max(largest, std::abs(x[k]));
  return largest;
}

class ActiveSet {
 public:
  explicit ActiveSet(int capacity);

  int size() const { return count_; }                 ///< p
  int operator[](int k) const { return active_[k]; }  ///< P, in the order of the factor's rows
  bool contains(int i) const { return is_active_[i]; }
  void clear() noexcept;

  /// Appends j to P. If j depends on P, returns false and leaves P unchanged; null_direction() then returns
  /// the d with S_j = −Σ d_P S_P to round-off. If P ∪ j is known to be regular (`trusted`), any positive
  /// Schur complement is accepted. O(p²).
  bool enter(const Symmetric& S, int j, bool trusted) noexcept;

  /// Removes the index at `position`; later indices move up by one. O(p²).
  /// Round-off does not accumulate, however long the factor is kept. Removing an index rotates only the rows
  /// of indices that entered later, and an index that returns is appended at the end. A row is therefore
  /// rotated at most once for each older index, which causes as much round-off as a new factorisation.
  void leave(int position) noexcept;

  /// Computes the factor of another matrix S (n,n). Indices that depend on earlier ones or are not below n
  /// are removed; the result is false if there are any. O(p³).
  bool renew(const Symmetric& S) noexcept;

  /// Computes z = S_PP⁻¹ r_P. O(p²).
  void minimise(const Eigen::Ref<const Eigen::VectorXd>& r, std::vector<double>& z) const noexcept;

  const std::vector<double>& null_direction() const { return d_; }  ///< (p) d_P

  void archive(auto& a) { a(count_, active_, is_active_, factor_, reciprocal_, row_, d_); }

 private:
  using Factor = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
  Factor factor() const { return {factor_.data(), count_, count_, Eigen::OuterStride<>(stride_)}; }
  double* at(int row, int column) { return factor_.data() + column * stride_ + row; }

  Eigen::Index stride_;
  int count_ = 0;
  std::vector<int> active_;
  std::vector<char> is_active_;
  base::Reserved<double> factor_;   ///< (p, stride) columns of L, S_PP = L Lᵀ
  std::vector<double> reciprocal_;  ///< (p) of the diagonal of L
  std::vector<double> row_;         ///< (p) scratch
  std::vector<double> d_;
};

}  // namespace ricochet::contact
