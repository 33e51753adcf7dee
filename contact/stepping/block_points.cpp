// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/block_points.hpp"

#include <algorithm>

#include "contact/law/mean_force.hpp"

namespace ricochet::contact {

template <class T>
PointPrediction<T>::PointPrediction(const BlockSystem<T>& system)
    : length_(system.length),
      width_(system.width),
      u_(length_ * width_),
      has_(system.points),
      rigid_(Vector::Zero(length_)) {}

template <class T>
void PointPrediction<T>::clear() noexcept {
  std::fill(has_.begin(), has_.end(), 0);
}

template <class T>
void PointPrediction<T>::add(const BlockSystem<T>& system, const BlockMotion<T>& motion,
                             const BlockForcing& forcing, const BlockForce<T>& held,
                             std::span<const int> rows) noexcept {
  for (int i : rows) {
    has_[i] = 1;
    if (!system.rigid.empty()) rigid_.noalias() = motion.rigid() * system.rigid_B.row(i).transpose();
    const double yielded = held.yielded(system, i);
    for (int l = 1; l <= system.length; ++l)
      u_[(l - 1) * width_ + i] = forcing.s(l, i) + rigid_(l - 1) - yielded;
  }
  system.loops->displacement(system.modes, system.B.data(), rows.data(), rows.size(), motion.predicted(),
                             system.length, u_.data(), width_);
}

template <class T>
double PointPrediction<T>::largest(int row) const noexcept {
  double out = u(row, 1);
  for (int l = 2; l <= length_; ++l) {
    const double next = u(row, l);
    out = next > out || next != next ? next : out;
  }
  return out;
}

template <class T>
KeptPoints<T>::KeptPoints(const BlockSystem<T>& system)
    : width_(system.width),
      position_(system.points, -1),
      u_(system.length * width_),
      was_kept_(system.points),
      ended_(Vector::Zero(system.points)),
      S_(system.points),
      S_mean_(system.plain->conserving ? system.points : 0),
      R_(system.yields ? system.points : 0),
      lag_(system.points * system.length * system.width),
      pushed_(ended_),
      yielded_(ended_) {
  for (std::vector<int>* x : {&rows_, &gathered_}) x->reserve(system.points);
  has_lags_.reserve(system.points);
}

template <class T>
void KeptPoints<T>::clear() noexcept {
  for (int i : rows_) position_[i] = -1;
  rows_.clear();
}

template <class T>
void KeptPoints<T>::add(int row) noexcept {
  position_[row] = size();
  rows_.push_back(row);
}

template <class T>
void KeptPoints<T>::end(int l) noexcept {
  std::fill(was_kept_.begin(), was_kept_.end(), 0);
  for (int k = 0; k < size(); ++k) {
    was_kept_[rows_[k]] = 1;
    ended_(rows_[k]) = u(k, l);
  }
}

template <class T>
void KeptPoints<T>::gather(const BlockSystem<T>& system, const BlockForce<T>& held) noexcept {
  if (rows_.empty()) return;
  const Eigen::Index n = size();
  if (gathered_ != rows_) {
    gathered_ = rows_;
    has_lags_.assign(gathered_.size(), 0);
    near_width_ = simd::padded(gathered_.size(), simd::point_pad);
    lag_.resize(gathered_.size() * system.length * near_width_);
    auto S = S_.begin(n);
    for (Eigen::Index j = 0; j < n; ++j)
      for (Eigen::Index i = 0; i < n; ++i) S(i, j) = system.matrices->M(rows_[j], rows_[i]);
    if (system.yields) {
      auto R = R_.begin(n);
      for (Eigen::Index j = 0; j < n; ++j)
        for (Eigen::Index i = 0; i < n; ++i) R(i, j) = system.plain->model->R(rows_[j], rows_[i]);
      if (system.plain->conserving) S_mean_.begin(n) = conserving_mean.end * S + R;
      S += R;
    }
  }
  const StepMatrices gathered = matrices();
  pushed_.head(n).setZero();
  yielded_.head(n).setZero();
  for (Eigen::Index k = 0; k < n; ++k)
    if (const double force = held.force(rows_[k]); force != 0) {
      pushed_.head(n) += force * gathered.S.col(k).head(n);
      if (system.yields) yielded_.head(n) += force * gathered.R.col(k).head(n);
    }
}

/// Gathers the lags of a point unless they are present.
template <class T>
void KeptPoints<T>::need_lags(const BlockSystem<T>& system, int position) noexcept {
  const auto at = static_cast<std::size_t>(position), L = static_cast<std::size_t>(system.length);
  if (has_lags_[at] != 0) return;
  has_lags_[at] = 1;
  const T* from = system.matrices->lags(gathered_[at]);
  T* to = &lag_[at * L * near_width_];
  for (std::size_t d = 0; d < L; ++d, from += system.width, to += near_width_) {
    for (std::size_t k = 0; k < gathered_.size(); ++k) to[k] = from[system.matrices->place(gathered_[k])];
    std::fill(to + gathered_.size(), to + near_width_, T(0));
  }
}

template <class T>
void KeptPoints<T>::push(const BlockSystem<T>& system, int l, std::span<const int> positions,
                         std::span<const T> changes) noexcept {
  if (positions.empty()) return;
  for (int position : positions) need_lags(system, position);
  system.loops->near(near_width_, lag_.data(), system.length, positions.data(), positions.size(),
                     changes.data(), system.length - l + 1, &u(0, l), width_);
}

template class PointPrediction<double>;
template class PointPrediction<float>;
template class KeptPoints<double>;
template class KeptPoints<float>;

}  // namespace ricochet::contact
