// SPDX-License-Identifier: BSD-2-Clause
// A regular grid whose cells contain points, to find the points near a position.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace ricochet::surface {

class Grid {
 public:
  /// @param cell  edge of the cells [m], about as large as the radius of a search
  explicit Grid(double cell) : cell_(cell) {}

  void add(std::size_t number, const Eigen::Vector3d& x) { points_[key(x)].push_back(number); }

  /// Calls `visit` with the number of every point within `radius` of x, and of some points farther away.
  template <class Visit>
  void near(const Eigen::Vector3d& x, double radius, Visit&& visit) const {
    const Eigen::Vector3d aside = Eigen::Vector3d::Constant(radius);
    const Key first = key(x - aside), last = key(x + aside);
    for (Key at = first; at[0] <= last[0]; ++at[0])
      for (at[1] = first[1]; at[1] <= last[1]; ++at[1])
        for (at[2] = first[2]; at[2] <= last[2]; ++at[2])
          if (const auto found = points_.find(at); found != points_.end())
            for (const std::size_t number : found->second) visit(number);
  }

 private:
  using Key = std::array<std::int64_t, 3>;
  struct Hash {
    std::size_t operator()(const Key& key) const {
      std::uint64_t h = 0;
      for (const std::int64_t k : key) h = (h ^ static_cast<std::uint64_t>(k)) * 0x9E3779B97F4A7C15U;
      return static_cast<std::size_t>(h ^ (h >> 32));
    }
  };

  Key key(const Eigen::Vector3d& x) const {
    Key out{};
    for (int k = 0; k < 3; ++k)
      out[static_cast<std::size_t>(k)] = static_cast<std::int64_t>(std::floor(x[k] / cell_));
    return out;
  }

  double cell_;
  std::unordered_map<Key, std::vector<std::size_t>, Hash> points_;
};

}  // namespace ricochet::surface
