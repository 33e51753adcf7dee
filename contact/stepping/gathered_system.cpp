// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/gathered_system.hpp"

#include <algorithm>

namespace ricochet::contact {

template <class T>
GatheredSystem<T>::GatheredSystem(const BlockSystem<T>& system)
    : S(system.points, system.points),
      S_mean(system.plain->S_mean.rows(), system.plain->S_mean.cols()),
      M(system.points, system.points),
      R(system.yields ? system.points : 0, system.yields ? system.points : 0),
      room_(system.points * system.length * system.width) {
  lag = std::make_unique_for_overwrite<T[]>(room_);
  points_.reserve(system.points);
  has_lags_.reserve(system.points);
}

template <class T>
GatheredSystem<T>::GatheredSystem(const GatheredSystem& other)
    : S(other.S.rows(), other.S.cols()),
      S_mean(other.S_mean.rows(), other.S_mean.cols()),
      M(other.M.rows(), other.M.cols()),
      R(other.R.rows(), other.R.cols()),
      lag(std::make_unique_for_overwrite<T[]>(other.room_)),
      room_(other.room_) {
  points_.reserve(S.rows());
  has_lags_.reserve(S.rows());
}

template <class T>
GatheredSystem<T>& GatheredSystem<T>::operator=(const GatheredSystem& other) {
  if (room_ != other.room_) return *this = GatheredSystem(other);
  holds_ = false;
  return *this;
}

template <class T>
void GatheredSystem<T>::take(const BlockSystem<T>& system, std::span<const int> points) noexcept {
  holds_ = true;
  points_.assign(points.begin(), points.end());
  has_lags_.assign(points.size(), 0);
  width = simd::padded(points.size(), simd::point_pad);
  const auto n = static_cast<Eigen::Index>(points.size());
  S.topLeftCorner(n, n) = system.plain->S(points, points);
  M.topLeftCorner(n, n) = system.plain->M(points, points);
  if (S_mean.size() > 0) S_mean.topLeftCorner(n, n) = system.plain->S_mean(points, points);
  if (system.yields) R.topLeftCorner(n, n) = system.plain->R(points, points);
}

template <class T>
void GatheredSystem<T>::need(const BlockSystem<T>& system, int position) noexcept {
  const auto at = static_cast<std::size_t>(position), L = static_cast<std::size_t>(system.length);
  if (has_lags_[at] != 0) return;
  has_lags_[at] = 1;
  const T* from = &system.lag[points_[at] * L * system.width];
  T* to = &lag[at * L * width];
  for (std::size_t d = 0; d < L; ++d, from += system.width, to += width) {
    for (std::size_t k = 0; k < points_.size(); ++k) to[k] = from[points_[k]];
    std::fill(to + points_.size(), to + width, T(0));
  }
}

template class GatheredSystem<double>;
template class GatheredSystem<float>;

}  // namespace ricochet::contact
