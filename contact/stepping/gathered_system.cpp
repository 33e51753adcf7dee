// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/gathered_system.hpp"

#include <algorithm>

#include "contact/law/mean_force.hpp"

namespace ricochet::contact {

template <class T>
GatheredSystem<T>::GatheredSystem(const BlockSystem<T>& system)
    : S(system.points),
      S_mean(system.plain->conserving ? system.points : 0),
      M(system.points),
      R(system.yields ? system.points : 0),
      lag(system.points * system.length * system.width) {
  points_.reserve(system.points);
  has_lags_.reserve(system.points);
}

template <class T>
void GatheredSystem<T>::take(const BlockSystem<T>& system, std::span<const int> points) noexcept {
  points_.assign(points.begin(), points.end());
  has_lags_.assign(points.size(), 0);
  width = simd::padded(points.size(), simd::point_pad);
  lag.resize(points.size() * system.length * width);
  const auto n = static_cast<Eigen::Index>(points.size());
  auto modes = M.begin(n), all = S.begin(n);
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = 0; i < n; ++i) {
      modes(i, j) = system.matrices->M(points[j], points[i]);
      all(i, j) = modes(i, j);
    }
  if (!system.yields) return;
  auto residual = R.begin(n);
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = 0; i < n; ++i) residual(i, j) = system.plain->model->R(points[j], points[i]);
  all += residual;
  if (system.plain->conserving) S_mean.begin(n) = conserving_mean.end * modes + residual;
}

template <class T>
void GatheredSystem<T>::need(const BlockSystem<T>& system, int position) noexcept {
  const auto at = static_cast<std::size_t>(position), L = static_cast<std::size_t>(system.length);
  if (has_lags_[at] != 0) return;
  has_lags_[at] = 1;
  const T* from = system.matrices->lags(points_[at]);
  T* to = &lag[at * L * width];
  for (std::size_t d = 0; d < L; ++d, from += system.width, to += width) {
    for (std::size_t k = 0; k < points_.size(); ++k) to[k] = from[system.matrices->place(points_[k])];
    std::fill(to + points_.size(), to + width, T(0));
  }
}

template class GatheredSystem<double>;
template class GatheredSystem<float>;

}  // namespace ricochet::contact
