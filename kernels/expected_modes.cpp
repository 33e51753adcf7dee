// SPDX-License-Identifier: BSD-2-Clause
#include "kernels/expected_modes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace ricochet::kernels {

ExpectedCount expected_count(double mass, std::span<const double> inertia, double wave_speed) {
  const Eigen::Vector3d principal =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(Eigen::Map<const Eigen::Matrix3d>(inertia.data()))
          .eigenvalues();
  Eigen::Vector3d side;
  for (int k = 0; k < 3; ++k)
    side[k] = std::sqrt(std::max(6 / mass * (principal.sum() - 2 * principal[k]), 1e-300));
  std::sort(side.begin(), side.end());
  constexpr double pi = std::numbers::pi;
  if (side[1] < 1e-6 * side[2])
    return [slowness = side[2] / (pi * wave_speed)](double lambda) { return slowness * std::sqrt(lambda); };
  return [side, c = 0.6 * wave_speed](double lambda) {
    const double k = std::sqrt(lambda) / c, bending = 2 * k / side[0];
    return side[1] * side[2] / (4 * pi) * (2 * k * k + std::min(bending, 4 * k * k)) +
           side.prod() * k * k * k / (2 * pi * pi);
  };
}

}  // namespace ricochet::kernels
