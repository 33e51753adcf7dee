// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <Eigen/Dense>
#include <memory>
#include <span>
#include <vector>

#include "contact/stepping/block_system.hpp"

namespace ricochet::contact {

/// The parts of the system that the kept points of a block need, gathered into dense arrays. The kept points
/// change rarely. A copy has the same capacity but is empty.
template <class T>
class GatheredSystem {
 public:
  explicit GatheredSystem(const BlockSystem<T>& system);
  GatheredSystem(const GatheredSystem& other);
  GatheredSystem& operator=(const GatheredSystem& other);
  GatheredSystem(GatheredSystem&&) noexcept = default;
  GatheredSystem& operator=(GatheredSystem&&) noexcept = default;
  ~GatheredSystem() = default;

  bool holds() const { return holds_; }
  void take(const BlockSystem<T>& system, std::span<const int> points) noexcept;
  /// Gathers the lags of a point with a force unless they are present.
  void need(const BlockSystem<T>& system, int position) noexcept;

  std::size_t width = 0;            ///< padded number of points
  Eigen::MatrixXd S, S_mean, M, R;  ///< (points, points) as in StepSystem
  std::unique_ptr<T[]> lag;         ///< (points, L, width) S_d

 private:
  std::size_t room_;  ///< capacity of `lag`
  bool holds_ = false;
  std::vector<int> points_;
  std::vector<char> has_lags_;  ///< by position
};

}  // namespace ricochet::contact
