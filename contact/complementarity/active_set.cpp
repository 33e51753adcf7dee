// SPDX-License-Identifier: BSD-2-Clause
#include "contact/complementarity/active_set.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/simd/dense.hpp"

namespace ricochet::contact {
namespace {

/// A Schur complement below this share of its diagonal entry is examined more closely.
constexpr double suspicious = 1e-8;

/// Up to this many indices, plain loops are faster than Eigen's blocked solvers.
constexpr int few = 24;

Eigen::Map<Eigen::VectorXd> head(std::vector<double>& x, int n) { return {x.data(), n}; }

}  // namespace

ActiveSet::ActiveSet(int capacity)
    : stride_(std::max(capacity, 1)), factor_(static_cast<std::size_t>(stride_ * stride_)) {
  const auto n = static_cast<std::size_t>(stride_);
  active_.resize(n);
  is_active_.resize(n);
  row_.resize(n);
  d_.resize(n);
  reciprocal_.resize(n);
}

void ActiveSet::clear() noexcept {
  for (int k = 0; k < count_; ++k) is_active_[active_[k]] = 0;
  count_ = 0;
}

/// j depends on P if its Schur complement dᵀ S d with d_j = 1 and d_P = −S_PP⁻¹ S_Pj is within the round-off
/// of that sum, 4 n ε (Σ |d_i| √S_ii)².
bool ActiveSet::enter(const Symmetric& S, int j, bool trusted) noexcept {
  const double* const column = &S.coeffRef(0, j);
  for (int k = 0; k < count_; ++k) row_[k] = column[active_[k]];
  auto l = head(row_, count_);
  factor().triangularView<Eigen::Lower>().solveInPlace(l);
  const double schur = column[j] - l.squaredNorm();
  if (!(schur > (trusted ? 0.0 : suspicious * column[j]))) {
    if (trusted) return false;
    auto d = head(d_, count_);
    d = -l;
    factor().transpose().triangularView<Eigen::Upper>().solveInPlace(d);
    double sum = std::sqrt(column[j]);
    for (int k = 0; k < count_; ++k) sum += std::abs(d_[k]) * std::sqrt(S(active_[k], active_[k]));
    const double n = static_cast<double>(std::max<Eigen::Index>(S.rows(), 10));
    if (!(schur > 4 * n * std::numeric_limits<double>::epsilon() * sum * sum)) return false;
  }
  factor_.resize(static_cast<std::size_t>((count_ + 1) * stride_));
  for (int k = 0; k < count_; ++k) *at(count_, k) = row_[k];
  *at(count_, count_) = std::sqrt(schur);
  reciprocal_[count_] = 1 / *at(count_, count_);
  active_[count_++] = j;
  is_active_[j] = 1;
  return true;
}

/// Without row k of L, the part of S_PP that follows index k is L₃₃ L₃₃ᵀ + l lᵀ, where l is the part of
/// column k below the diagonal. Givens rotations merge l into the columns of L₃₃ one by one; these columns
/// move up and to the left.
void ActiveSet::leave(int position) noexcept {
  is_active_[active_[position]] = 0;
  std::copy(active_.begin() + position + 1, active_.begin() + count_, active_.begin() + position);
  const int last = --count_;
  for (int c = 0; c < position; ++c) std::copy(at(position + 1, c), at(last + 1, c), at(position, c));
  std::copy(at(position + 1, position), at(last + 1, position), row_.data() + position);
  for (int c = position; c < last; ++c) {
    const double* const old = at(c + 1, c + 1);
    double* const __restrict fresh = at(c, c);
    double* const __restrict l = row_.data() + c;
    const double norm = std::hypot(old[0], l[0]), cosine = old[0] / norm, sine = l[0] / norm;
    for (int i = 0; i < last - c; ++i) {
      const double a = old[i], b = l[i];
      fresh[i] = cosine * a + sine * b;
      l[i] = cosine * b - sine * a;
    }
    reciprocal_[c] = 1 / fresh[0];
  }
}

bool ActiveSet::renew(const Symmetric& S) noexcept {
  const int wanted = count_;
  clear();
  for (int k = 0; k < wanted; ++k)
    if (active_[k] < S.rows()) enter(S, active_[k], false);
  return count_ == wanted;
}

void ActiveSet::minimise(const Eigen::Ref<const Eigen::VectorXd>& r, std::vector<double>& z) const noexcept {
  for (int k = 0; k < count_; ++k) z[k] = r(active_[k]);
  if (count_ <= few) {
    simd::dense().solve_factor(static_cast<std::size_t>(count_), factor_.data(),
                               static_cast<std::size_t>(stride_), reciprocal_.data(), z.data());
    return;
  }
  auto x = head(z, count_);
  factor().triangularView<Eigen::Lower>().solveInPlace(x);
  factor().transpose().triangularView<Eigen::Upper>().solveInPlace(x);
}

}  // namespace ricochet::contact
