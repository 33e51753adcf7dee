// SPDX-License-Identifier: BSD-2-Clause
// The points of a look-ahead block: their displacement under the held force, and those that the block keeps
// because they could close.
#pragma once

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "contact/stepping/block_motion.hpp"

namespace ricochet::contact {

/// ū, u of points in each step of a block under the held force and the forcing.
template <class T>
class PointPrediction {
 public:
  explicit PointPrediction(const BlockSystem<T>& system);

  void clear() noexcept;
  bool has(int row) const { return has_[row] != 0; }
  /// Predicts rows that are not predicted yet.
  void add(const BlockSystem<T>& system, const BlockMotion<T>& motion, const BlockForcing& forcing,
           const BlockForce<T>& held, std::span<const int> rows) noexcept;
  double u(int row, int l) const { return u_[(l - 1) * width_ + row]; }  ///< after step l = 1…L
  double largest(int row) const noexcept;                                ///< NaN if one of them is

  void archive(auto& a) { a(u_, has_); }

 private:
  int length_;
  std::size_t width_;
  base::AlignedVector<double> u_;  ///< (L, width)
  std::vector<char> has_;          ///< (n)
  Vector rigid_;                   ///< (L) scratch: part of rigid motion
};

/// The kept points with their u, and the matrices between them, in dense arrays. They change rarely.
template <class T>
class KeptPoints {
 public:
  explicit KeptPoints(const BlockSystem<T>& system);

  std::span<const int> rows() const { return rows_; }
  int size() const { return static_cast<int>(rows_.size()); }
  bool has(int row) const { return position_[row] >= 0; }
  void clear() noexcept;
  /// Keeps a row, whose u the caller sets.
  void add(int row) noexcept;
  /// u after step l = 1…L, by position.
  double& u(int position, int l) { return u_[(l - 1) * width_ + position]; }

  /// Notes u at the end of a block, after step l.
  void end(int l) noexcept;
  /// u of a row there, or null if the block did not keep it.
  const double* ended(int row) const { return was_kept_[row] != 0 ? &ended_(row) : nullptr; }

  /// The rows that the matrices contain.
  std::span<const int> gathered() const { return gathered_; }
  /// Gathers the matrices of the kept rows, and what the held force does.
  void gather(const BlockSystem<T>& system, const BlockForce<T>& held) noexcept;
  StepMatrices matrices() const { return {.R = R_.view(), .S = S_.view(), .S_mean = S_mean_.view()}; }
  const Vector& pushed() const { return pushed_; }    ///< by position: S λ̂ [m]
  const Vector& yielded() const { return yielded_; }  ///< by position: R λ̂ [m]
  /// u from step l on, minus M times changes of force in step l. @param positions, changes  of these changes
  void push(const BlockSystem<T>& system, int l, std::span<const int> positions,
            std::span<const T> changes) noexcept;

  void archive(auto& a, const BlockSystem<T>& system) {
    a(rows_, position_, u_, was_kept_, ended_, gathered_, near_width_, S_, S_mean_, R_, lag_, has_lags_);
    a(pushed_, yielded_);
    if (!a.reads() || a.failed()) return;
    for (const std::vector<int>* rows : {&rows_, &gathered_})
      for (const int row : *rows) system.matrices->need(row);
  }

 private:
  void need_lags(const BlockSystem<T>& system, int position) noexcept;

  std::size_t width_;  ///< padded number of all points
  std::vector<int> rows_;
  std::vector<int> position_;      ///< (n) in rows_, or −1
  base::AlignedVector<double> u_;  ///< (L, width)
  std::vector<char> was_kept_;
  Vector ended_;
  std::vector<int> gathered_;
  std::size_t near_width_ = 0;     ///< padded number of gathered points
  ReservedMatrix S_, S_mean_, R_;  ///< (points, points) as in RowMatrices
  base::Reserved<T> lag_;          ///< (points, L, near width) M_d
  std::vector<char> has_lags_;     ///< by position
  Vector pushed_, yielded_;
};

}  // namespace ricochet::contact
