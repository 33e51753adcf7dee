// SPDX-License-Identifier: BSD-2-Clause
// The active set P of a complementarity problem with the Cholesky factor of S_PP, kept as indices enter and
// leave. Takes memory in the constructor only.
#pragma once

#include <Eigen/Dense>
#include <vector>

namespace ricochet::contact {

/// S (n,n), symmetric positive semidefinite, both triangles.
using Symmetric = Eigen::Ref<const Eigen::MatrixXd>;

class ActiveSet {
 public:
  explicit ActiveSet(int capacity);

  int size() const { return count_; }                 ///< p
  int operator[](int k) const { return active_[k]; }  ///< P, in the order of the factor's rows
  bool contains(int i) const { return is_active_[i]; }
  void clear() noexcept;

  /// Appends j. False, P unchanged, when j depends on P: null_direction() is then d with S_j = −Σ d_P S_P to
  /// round-off. `trusted`: P ∪ j is known to be regular, so any positive Schur complement will do. O(p²).
  bool enter(const Symmetric& S, int j, bool trusted) noexcept;

  /// Takes out the index at `position`; those behind it move up by one. O(p²). However long the factor is
  /// kept, its round-off does not grow: only rows that entered later are rotated, and an index that comes
  /// back is the latest, so a row is rotated for each older one at most, which is as much round-off as in a
  /// new factor.
  void leave(int position) noexcept;

  /// Computes the factor of another matrix, and leaves out what depends on the indices before it or lies
  /// beyond n; false when that was so. O(p³).
  bool renew(const Symmetric& S) noexcept;

  /// z = S_PP⁻¹ r_P. O(p²).
  void minimise(const Eigen::Ref<const Eigen::VectorXd>& r, std::vector<double>& z) const noexcept;

  const std::vector<double>& null_direction() const { return d_; }  ///< (p) d_P

 private:
  using Factor = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
  Factor factor() const { return {factor_.data(), count_, count_, Eigen::OuterStride<>(stride_)}; }
  double* at(int row, int column) { return factor_.data() + column * stride_ + row; }

  Eigen::Index stride_;
  int count_ = 0;
  std::vector<int> active_;
  std::vector<char> is_active_;
  std::vector<double> factor_;  ///< L of S_PP = L Lᵀ, column-major
  std::vector<double> row_;     ///< (p) scratch
  std::vector<double> d_;
};

}  // namespace ricochet::contact
