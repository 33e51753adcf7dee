// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "contact/stepping/block_system.hpp"

namespace ricochet::contact {

/// The parts of the system that the kept points of a block need, gathered into dense arrays. The kept points
/// change rarely.
template <class T>
class GatheredSystem {
 public:
  explicit GatheredSystem(const BlockSystem<T>& system);

  void take(const BlockSystem<T>& system, std::span<const int> points) noexcept;
  /// Gathers the lags of a point with a force unless they are present.
  void need(const BlockSystem<T>& system, int position) noexcept;

  std::size_t width = 0;           ///< padded number of points
  ReservedMatrix S, S_mean, M, R;  ///< (points, points) as in RowMatrices
  base::Reserved<T> lag;           ///< (points, L, width) M_d
  StepMatrices all() const { return {.M = M.view(), .R = R.view(), .S = S.view(), .S_mean = S_mean.view()}; }

 private:
  std::vector<int> points_;
  std::vector<char> has_lags_;  ///< by position
};

}  // namespace ricochet::contact
