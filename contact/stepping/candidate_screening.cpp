// SPDX-License-Identifier: BSD-2-Clause
// Which points a block watches, and what it gathers of its system for them.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "contact/stepping/look_ahead_block.hpp"

namespace ricochet::contact {
namespace {

/// A point is expected to change its force by so many times what it did in the block before.
constexpr double growth = 2;

/// A new set of watched points takes in those that so many times the expected changes could reach, to last.
constexpr double ahead = 1.5;

constexpr auto every_band = [] {
  std::array<int, bands> out{};
  for (int k = 0; k < bands; ++k) out[static_cast<std::size_t>(k)] = k;
  return out;
}();

/// Σ of so many positive terms, each of which was rounded: at least as large as the true one.
template <class T>
double at_least(T sum, std::size_t terms) {
  return static_cast<double>(sum) *
         (1 + 2 * static_cast<double>(terms + 2) * static_cast<double>(std::numeric_limits<T>::epsilon()));
}

}  // namespace

template <class T>
Gathered<T>::Gathered(const BlockSystem<T>& system)
    : S(system.points, system.points),
      R(system.points, system.points),
      room_(static_cast<std::size_t>(system.points * system.length) * system.width) {
  lag = std::make_unique_for_overwrite<T[]>(room_);
  points_.reserve(static_cast<std::size_t>(system.points));
  has_lags_.reserve(static_cast<std::size_t>(system.points));
}

template <class T>
Gathered<T>::Gathered(const Gathered& other)
    : S(other.S.rows(), other.S.cols()),
      R(other.R.rows(), other.R.cols()),
      lag(std::make_unique_for_overwrite<T[]>(other.room_)),
      room_(other.room_) {
  points_.reserve(static_cast<std::size_t>(S.rows()));
  has_lags_.reserve(static_cast<std::size_t>(S.rows()));
}

template <class T>
Gathered<T>& Gathered<T>::operator=(const Gathered& other) {
  if (room_ != other.room_) return *this = Gathered(other);
  holds_ = false;
  return *this;
}

template <class T>
void Gathered<T>::take(const BlockSystem<T>& system, std::span<const int> points) noexcept {
  holds_ = true;
  points_.assign(points.begin(), points.end());
  has_lags_.assign(points.size(), 0);
  width = simd::padded(points.size(), simd::point_pad);
  const auto n = static_cast<Eigen::Index>(points.size());
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = 0; i < n; ++i) S(i, j) = system.plain->S(points_[i], points_[j]);
  if (!system.yields) return;
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = 0; i < n; ++i) R(i, j) = system.plain->R(points_[i], points_[j]);
}

template <class T>
void Gathered<T>::need(const BlockSystem<T>& system, int position) noexcept {
  const auto at = static_cast<std::size_t>(position), L = static_cast<std::size_t>(system.length);
  if (has_lags_[at] != 0) return;
  has_lags_[at] = 1;
  const T* from = &system.lag[static_cast<std::size_t>(points_[at]) * L * system.width];
  T* to = &lag[at * L * width];
  for (std::size_t d = 0; d < L; ++d, from += system.width, to += width) {
    for (std::size_t k = 0; k < points_.size(); ++k) to[k] = from[points_[k]];
    std::fill(to + points_.size(), to + width, T(0));
  }
}

/// could_: what changes as large as budget_ could add, where changes are expected to be some times those of
/// the block before. Clears the latter.
template <class T>
void LookAheadBlock<T>::expect() noexcept {
  budget_.setZero();
  factor_.clear();
  for (int i : have_changed_) {
    budget_(i) = growth * spent_(i);
    factor_.push_back(static_cast<T>(budget_(i)));
  }
  combine(system_->influence, have_changed_);
  for (int i = 0; i < system_->points; ++i)
    could_(i) = at_least(sum_[static_cast<std::size_t>(i)], have_changed_.size());
  for (int i : have_changed_) {
    has_changed_[static_cast<std::size_t>(i)] = 0;
    std::fill_n(changes_.begin() + i * length(), length(), T(0));
  }
  have_changed_.clear();
  spent_.setZero();
}

/// sum_ = Σ_k factor_k row_k of a matrix (·, width)
template <class T>
void LookAheadBlock<T>::combine(const std::vector<T>& rows, std::span<const int> of) noexcept {
  system_->loops->combine(system_->width, rows.data(), system_->width, of.data(), of.size(), factor_.data(),
                          sum_.data());
}

/// margin_: the gap less the farthest that a point gets at the end of any step. Without force the energy of
/// an elastic mode about its rest never grows, and |Σ B y| ≤ (Σ B²/ω²)^½ (Σ ω²y² + ẏ²)^½.
template <class T>
void LookAheadBlock<T>::bound_by_energy() noexcept {
  const BlockSystem<T>& of = *system_;
  factor_.clear();
  for (int j : pressed_) factor_.push_back(static_cast<T>(held_force_(j)));
  combine(of.flexibility, pressed_);
  const double slack = 2 * held_force_.sum() * static_cast<double>(pressed_.size() + 2) *
                       static_cast<double>(std::numeric_limits<T>::epsilon());
  for (int i = 0; i < of.points; ++i)
    margin_(i) = of.plain->gap(i) - of.rest(i) + static_cast<double>(sum_[static_cast<std::size_t>(i)]) -
                 slack * of.largest(i);

  factor_.clear();
  for (const std::vector<int>& band : of.band) {
    double energy = 0;
    for (int n : band) {
      const auto k = static_cast<std::size_t>(n);
      const double y = q_[k] - load_[k] * of.softness[k];
      energy += of.stiffness[k] * y * y + v_[k] * v_[k];
    }
    factor_.push_back(static_cast<T>(std::sqrt(energy)));
  }
  combine(of.reach, every_band);
  for (int i = 0; i < of.points; ++i) {
    margin_(i) -= at_least(sum_[static_cast<std::size_t>(i)], bands);
    if (of.rigid.empty()) continue;
    rigid_at_.noalias() = rigid_motion_ * of.rigid_B.row(i).transpose();
    margin_(i) -= rigid_at_.maxCoeff();
  }
}

/// Sets ahead_ of `rows`, and margin_ to what is left of their gaps without changes of force.
template <class T>
void LookAheadBlock<T>::predict(std::span<const int> rows) noexcept {
  const std::size_t width = system_->width;
  for (int i : rows) {
    is_predicted_[static_cast<std::size_t>(i)] = 1;
    if (!system_->rigid.empty()) rigid_at_.noalias() = rigid_motion_ * system_->rigid_B.row(i).transpose();
    for (int l = 0; l < length(); ++l)
      ahead_[static_cast<std::size_t>(l) * width + static_cast<std::size_t>(i)] =
          s_(forced_ ? l + 1 : 0, i) + rigid_at_(l) - held_rest_(i);
  }
  system_->loops->displacement(system_->modes, system_->B.data(), rows.data(), rows.size(), x_.data(),
                               static_cast<std::size_t>(length()), ahead_.data(), width);
  for (int i : rows) {
    double farthest = ahead_[static_cast<std::size_t>(i)];
    for (int l = 1; l < length(); ++l) {
      const double u = ahead_[static_cast<std::size_t>(l) * width + static_cast<std::size_t>(i)];
      farthest = u > farthest || u != u ? u : farthest;
    }
    margin_(i) = system_->plain->gap(i) - farthest;
  }
}

/// Predicts those points that could close if changes were `times` what is expected.
template <class T>
void LookAheadBlock<T>::predict_what_matters(double times) noexcept {
  predicted_.clear();
  for (int i = 0; i < system_->points; ++i)
    if (is_predicted_[static_cast<std::size_t>(i)] == 0 && matters(i, times)) predicted_.push_back(i);
  predict(predicted_);
}

template <class T>
void LookAheadBlock<T>::choose_watched() noexcept {
  if (forced_)
    margin_.setConstant(-1);  // the energy may grow: all are predicted
  else
    bound_by_energy();
  predict_what_matters(1);
  std::size_t needed = 0, kept = 0;
  for (int i = 0; i < system_->points; ++i) needed += matters(i, 1) ? 1 : 0;
  for (int i : gathered_) kept += matters(i, 1) ? 1 : 0;
  // Points too many cost less than a new matrix, up to a point.
  const bool keep = needed > 0 && kept == needed && gathered_.size() <= 2 * needed + 8;
  for (int i : watched_) position_[static_cast<std::size_t>(i)] = -1;
  watched_.clear();
  if (keep) {
    predicted_.clear();
    for (int i : gathered_)
      if (is_predicted_[static_cast<std::size_t>(i)] == 0) predicted_.push_back(i);
    predict(predicted_);
    for (int i : gathered_) watch(i);
  } else if (needed > 0) {
    predict_what_matters(ahead);
    for (int i = 0; i < system_->points; ++i)
      if (matters(i, ahead)) watch(i);
  }
  if (!watched_.empty()) gather();
}

/// Makes up for the forces so far. The point is predicted.
template <class T>
void LookAheadBlock<T>::watch(int point) noexcept {
  const std::size_t k = watched_.size(), width = system_->width;
  const auto i = static_cast<std::size_t>(point);
  position_[i] = static_cast<int>(k);
  watched_.push_back(point);
  for (int l = 1; l <= length(); ++l) u(k, l) = ahead_[static_cast<std::size_t>(l - 1) * width + i];
  for (int j : have_changed_) {
    const T* lag = &system_->lag[static_cast<std::size_t>(j * length()) * width + i];
    for (int from = 1; from <= taken_; ++from) {
      const auto change = static_cast<double>(changes_[static_cast<std::size_t>(j * length() + from - 1)]);
      if (change == 0) continue;
      for (int l = from; l <= length(); ++l)
        u(k, l) -= change * static_cast<double>(lag[static_cast<std::size_t>(l - from) * width]);
    }
  }
}

template <class T>
void LookAheadBlock<T>::gather() noexcept {
  const bool same = gathered_ == watched_;
  if (!same) {
    gathered_ = watched_;
    is_new_problem_ = true;
  }
  if (!same || !near_.holds()) near_.take(*system_, gathered_);
  const auto n = static_cast<Eigen::Index>(watched_.size());
  held_push_.head(n).setZero();
  for (Eigen::Index k = 0; k < n; ++k)
    if (const double force = held_force_(watched_[k]); force != 0)
      held_push_.head(n) += force * near_.S.col(k).head(n);
}

/// Gives points more whose forces change by more than could_ counts with. Whether there are any.
template <class T>
bool LookAheadBlock<T>::raise_budgets() noexcept {
  raised_.clear();
  factor_.clear();
  for (std::size_t k = 0; k < watched_.size(); ++k) {
    const int i = watched_[k];
    const double spent = spent_(i) + std::abs(solution_(static_cast<Eigen::Index>(k)) - held_force_(i));
    if (spent <= budget_(i)) continue;
    raised_.push_back(i);
    factor_.push_back(static_cast<T>(growth * spent - budget_(i)));
    budget_(i) = growth * spent;
  }
  if (raised_.empty()) return false;
  combine(system_->influence, raised_);
  for (int i = 0; i < system_->points; ++i)
    could_(i) += at_least(sum_[static_cast<std::size_t>(i)], raised_.size());
  return true;
}

/// Takes points in that could now close. Whether there are any.
template <class T>
bool LookAheadBlock<T>::see_more() noexcept {
  predict_what_matters(1);
  bool more = false;
  for (int i = 0; i < system_->points; ++i)
    if (position_[static_cast<std::size_t>(i)] < 0 && matters(i, 1)) {
      watch(i);
      more = true;
    }
  if (more) gather();
  return more;
}

template class Gathered<double>;
template class Gathered<float>;
template class LookAheadBlock<double>;
template class LookAheadBlock<float>;

}  // namespace ricochet::contact
