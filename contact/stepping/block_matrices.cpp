// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/block_matrices.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "contact/stepping/propagator.hpp"

namespace ricochet::contact {

template <class T>
BlockMatrices<T>::BlockMatrices(const StepSystem& system, int steps, double step, double at_once)
    : model_(*system.model),
      loops_(simd::loops_of<double>(*simd::available().back())),
      length_(static_cast<std::size_t>(steps)),
      width_(simd::padded(static_cast<std::size_t>(model_.rows()), simd::point_pad)),
      modes_(simd::padded(static_cast<std::size_t>(model_.omega.size()))),
      all_(static_cast<std::size_t>(model_.rows())),
      place_(all_.size(), -1) {
  const std::size_t n = all_.size();
  std::iota(all_.begin(), all_.end(), 0);
  rows_.reserve(n);
  B_.assign(n * modes_, 0.0);
  factors_.assign((length_ + 1) * modes_, 0.0);
  for (Eigen::Index k = 0; k < model_.omega.size(); ++k) {
    const auto mode = static_cast<std::size_t>(k);
    for (std::size_t i = 0; i < n; ++i) B_[i * modes_ + mode] = model_.B(static_cast<Eigen::Index>(i), k);
    double before = 0;
    for (std::size_t d = 0; d < length_; ++d) {
      const double c = mode_response(model_.omega(k), model_.decay(k), static_cast<double>(d + 1) * step).c;
      factors_[d * modes_ + mode] = c - before;
      before = c;
    }
    if (system.stiffness(k) != 0) factors_[length_ * modes_ + mode] = 1 / system.stiffness(k);
  }
  x_.assign(factors_.size(), 0.0);
  sum_.assign((length_ + 1) * width_, 0.0);
  lag_ = base::Reserved<T>(n * length_ * width_);
  M_ = base::Reserved<double>(n * width_);
  for (base::Reserved<float>* x : {&influence_, &flexibility_}) *x = base::Reserved<float>(n * width_);
  constexpr std::size_t screening = 2 * sizeof(float);
  if (static_cast<double>(n * width_ * (sizeof(T) * length_ + screening + sizeof(double))) > at_once) return;
  for (const int row : all_) need(row);
}

template <class T>
void BlockMatrices<T>::need(int row) noexcept {
  if (place_[row] >= 0) return;
  const auto B = B_.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(row) * modes_);
  for (std::size_t d = 0; d <= length_; ++d)
    std::transform(B, B + static_cast<std::ptrdiff_t>(modes_), factors_.begin() + d * modes_,
                   x_.begin() + d * modes_, std::multiplies<>());
  std::fill(sum_.begin(), sum_.end(), 0.0);
  loops_.displacement(modes_, B_.data(), all_.data(), all_.size(), x_.data(), length_ + 1, sum_.data(),
                      width_);

  const std::size_t p = rows_.size(), size = p + 1;
  rows_.push_back(row);
  lag_.resize(size * length_ * width_);
  M_.resize(size * width_);
  for (std::size_t t = 0; t < size; ++t) {
    const double* const from = &sum_[static_cast<std::size_t>(rows_[t])];
    M_[p * width_ + t] = M_[t * width_ + p] = from[0];
    for (std::size_t d = 0; d < length_; ++d)
      lag_[(p * length_ + d) * width_ + t] = lag_[(t * length_ + d) * width_ + p] =
          static_cast<T>(from[d * width_]);
  }
  const auto append = [&](auto& matrix) {
    matrix.resize(size * width_);
    std::fill_n(matrix.data() + p * width_, width_, 0);
  };
  append(influence_);
  append(flexibility_);
  for (std::size_t i = 0; i < all_.size(); ++i) {
    const double R = model_.R(row, static_cast<Eigen::Index>(i));
    double most = std::abs(sum_[i]) + std::abs(R);
    for (std::size_t d = 1; d < length_; ++d) most = std::max(most, std::abs(sum_[d * width_ + i]));
    influence_[p * width_ + i] = rounded_up(most);
    flexibility_[p * width_ + i] = static_cast<float>(sum_[length_ * width_ + i] + R);
  }
  place_[row] = static_cast<int>(p);
}

template class BlockMatrices<double>;
template class BlockMatrices<float>;

}  // namespace ricochet::contact
