// SPDX-License-Identifier: BSD-2-Clause
// Tables in closed form for two rods, separated by a gap: ρ = A = E = 1, L = 10,
// Z = 1, v = 1.
#pragma once

#include "contact/table/table.hpp"

namespace ricochet::contact::test {

inline constexpr double step = 0.01, speed = 1;
inline constexpr std::int64_t around = 2000;  ///< steps in 2L/c

/// An impulse moves the end of a rod by 1/Z at once and by 2/Z at each return of the wave.
inline Table rods(double gap, std::int64_t samples) {
  Table table;
  table.step = step;
  const auto displacement = [](std::int64_t l) {  // of both rods together, just before lΔ
    return l == 0 ? 0.0 : 2.0 * (1 + 2 * static_cast<double>((l - 1) / around));
  };
  for (std::int64_t l = 0; l < samples; ++l) {
    table.displacement.push_back(displacement(l));
    table.velocity.push_back((displacement(l + 1) - displacement(l)) / step);
    table.flexibility.push_back(displacement(l + 1) * step);
  }
  table.gap = Vector::Constant(1, gap);
  table.area = Vector::Ones(1);
  Matrix push(1, 3);
  push << -1, 0, 0;
  table.bodies = {{"moving", 10, {speed, 0, 0}, Eigen::Vector3d::Zero(), push},
                  {"resting", 10, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), -push}};
  return table;
}

}  // namespace ricochet::contact::test
