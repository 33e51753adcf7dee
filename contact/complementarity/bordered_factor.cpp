// SPDX-License-Identifier: BSD-2-Clause
#include "contact/complementarity/bordered_factor.hpp"

#include <algorithm>

namespace ricochet::contact {
namespace {

using View = Eigen::Map<Eigen::VectorXd>;
using ConstView = Eigen::Map<const Eigen::VectorXd>;

}  // namespace

BorderedFactor::BorderedFactor(int capacity)
    : stride_(std::max(capacity, 1)),
      most_(most(std::max(capacity, 0))),
      factor_(capacity),
      small_(most_),
      columns_(static_cast<std::size_t>(stride_ * most_)),
      rows_(static_cast<std::size_t>(stride_ * most_)),
      schur_(static_cast<std::size_t>(most_ * most_)) {}

void BorderedFactor::append() noexcept {
  const int i = border_++;
  for (base::Reserved<double>* x : {&columns_, &rows_})
    x->resize(static_cast<std::size_t>(border_ * stride_));
  schur_.resize(static_cast<std::size_t>(border_ * most_));
  std::fill_n(column(i), size_, 0.0);
  std::fill_n(row(i), size_, 0.0);
  for (int j = 0; j <= i; ++j) corner(i, j) = corner(j, i) = 0;
}

void BorderedFactor::keep(const int* kept, int count) noexcept {
  for (int i = 0; i < count; ++i) {
    if (kept[i] == i) continue;
    std::copy_n(column(kept[i]), size_, column(i));
    std::copy_n(row(kept[i]), size_, row(i));
  }
  for (int j = 0; j < count; ++j)
    for (int i = 0; i < count; ++i) corner(i, j) = corner(kept[i], kept[j]);
  border_ = count;
}

void BorderedFactor::complete(int first) noexcept {
  for (int j = first; j < border_; ++j) factor_.solve(column(j));
  for (int j = 0; j < border_; ++j)
    for (int i = j < first ? first : 0; i < border_; ++i)
      corner(i, j) -= ConstView(row(i), size_).dot(ConstView(column(j), size_));
  auto small = small_.begin(border_);
  for (int j = 0; j < border_; ++j) std::copy_n(&corner(0, j), border_, small.col(j).data());
  small_.factor();
}

bool BorderedFactor::solve(double* x, double* y) noexcept {
  if (!factor_.solve(x)) return false;
  if (border_ == 0) return true;
  View at(x, size_);
  for (int i = 0; i < border_; ++i) y[i] -= ConstView(rows_.data() + i * stride_, size_).dot(at);
  if (!small_.solve(y)) return false;
  for (int i = 0; i < border_; ++i) at -= y[i] * ConstView(columns_.data() + i * stride_, size_);
  return true;
}

}  // namespace ricochet::contact
