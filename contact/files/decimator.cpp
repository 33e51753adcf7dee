// SPDX-License-Identifier: BSD-2-Clause
#include "contact/files/decimator.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace ricochet::contact {
namespace {

// For 100 dB and a transition of 0.1 of the output rate, Kaiser's formulas give β = 0.1102 (100 − 8.7) and a
// length of (100 − 7.95) n / (14.36 · 0.1) = 64.1 n.
constexpr double kaiser_beta = 10.06;
constexpr std::int64_t filter_reach = 33;  ///< length of each side, in output rows

std::vector<double> filter_for(std::int64_t every, std::int64_t half) {
  std::vector<double> h;
  double sum = 0;
  for (std::int64_t j = 0; j <= half; ++j) {
    const double x = std::numbers::pi * static_cast<double>(j) / static_cast<double>(every),
                 place = half > 0 ? static_cast<double>(j) / static_cast<double>(half) : 0;
    h.push_back(std::cyl_bessel_i(0, kaiser_beta * std::sqrt(1 - place * place)) *
                (j == 0 ? 1 : std::sin(x) / x));
    sum += (j == 0 ? 1 : 2) * h.back();
  }
  for (double& weight : h) weight /= sum;
  return h;
}

}  // namespace

Decimator::Decimator(int every, std::vector<double> slope)
    : every_(every),
      half_(every == 1 ? 0 : filter_reach * every),
      filter_(filter_for(every_, half_)),
      slope_(std::move(slope)),
      out_(slope_.size()) {}

const double* Decimator::row(std::int64_t number) const {
  return held_.data() + (number - first_) * std::ssize(slope_);
}

void Decimator::push(std::span<const double> row, const Take& take) {
  if (end_ == 0) {
    first_ = -half_;
    for (std::int64_t i = first_; i < 0; ++i)
      for (std::size_t c = 0; c < row.size(); ++c)
        held_.push_back(row[c] + static_cast<double>(i) * slope_[c]);
  }
  held_.insert(held_.end(), row.begin(), row.end());
  ++end_;
  emit(take);
  // Later output and the reflection need the last 2 half_ + 1 rows. Rows are removed in blocks of this size.
  const std::int64_t needed = 2 * half_ + 1;
  if (end_ - first_ < 2 * needed) return;
  held_.erase(held_.begin(), held_.end() - needed * std::ssize(slope_));
  first_ = end_ - needed;
}

void Decimator::finish(const Take& take) {
  if (end_ == 0) return;
  const std::int64_t last = end_ - 1;
  held_.reserve(held_.size() + static_cast<std::size_t>(half_) * slope_.size());
  for (; end_ <= last + half_; ++end_)
    for (std::size_t c = 0; c < slope_.size(); ++c)
      held_.push_back(2 * row(last)[c] - row(2 * last - end_)[c]);
  emit(take);
}

void Decimator::emit(const Take& take) {
  for (; next_ + half_ < end_; next_ += every_) {
    const double* const middle = row(next_);
    for (std::size_t c = 0; c < out_.size(); ++c) out_[c] = filter_[0] * middle[c];
    for (std::int64_t j = 1; j <= half_; ++j) {
      const double *const before = row(next_ - j), *const after = row(next_ + j);
      const double weight = filter_[static_cast<std::size_t>(j)];
      for (std::size_t c = 0; c < out_.size(); ++c) out_[c] += weight * (before[c] + after[c]);
    }
    take(next_, out_);
  }
}

}  // namespace ricochet::contact
