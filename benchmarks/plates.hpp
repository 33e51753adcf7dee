// SPDX-License-Identifier: BSD-2-Clause
// Two simply supported plates, one pressed on the other: persistent contact with modes in closed form, for
// any number of points and modes.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "contact/model/model.hpp"

namespace ricochet::benchmarks {

/// Model of two steel plates, 0.4 m × 0.3 m × 2 mm, 0.2 mm apart. A pressure acts on the upper plate that
/// would bend it alone by 1 mm.
/// @param nx, ny  contact points along the sides, distributed evenly over the plate
/// @param modes  modes of each plate; R contains the flexibility of 20 times as many further modes
inline contact::Model plates(int nx, int ny, int modes, double decay = 20) {
  constexpr double a = 0.4, b = 0.3, thickness = 2e-3, young = 2.1e11, poisson = 0.3, density = 7850;
  constexpr double gap = 2e-4, sag = 1e-3, pi = std::numbers::pi;
  const double stiffness = young * thickness * thickness * thickness / (12 * (1 - poisson * poisson));
  const double area_mass = density * thickness;
  struct Mode {
    double omega;
    int along, across;
  };
  std::vector<Mode> all;
  const int most = 8 * static_cast<int>(std::sqrt(modes)) + 20;
  for (int k = 1; k <= most; ++k)
    for (int l = 1; l <= most; ++l) {
      const double wave = pi * pi * (k * k / (a * a) + l * l / (b * b));
      all.push_back({wave * std::sqrt(stiffness / area_mass), k, l});
    }
  std::sort(all.begin(), all.end(), [](const Mode& x, const Mode& y) { return x.omega < y.omega; });
  all.resize(std::min<std::size_t>(all.size(), 21 * static_cast<std::size_t>(modes)));

  contact::Model model;
  const Eigen::Index m = nx * ny, N = 2 * modes;
  for (contact::Vector* x : {&model.omega, &model.decay, &model.load, &model.q0, &model.v0}) x->setZero(N);
  model.B.setZero(m, N);
  model.has_residual = true;
  model.gap.setConstant(m, gap);
  model.static_displacement.setZero(m);
  model.area.setConstant(m, a * b / static_cast<double>(m));
  contact::Vector trace(m);
  Eigen::MatrixXd others(m, static_cast<Eigen::Index>(all.size()) - modes);  // their traces over ω
  double pressure = 0;
  for (std::size_t n = 0; n < all.size(); ++n) {
    const auto& [omega, k, l] = all[n];
    const double scale = 2 / std::sqrt(area_mass * a * b);
    for (int i = 0; i < nx; ++i)
      for (int j = 0; j < ny; ++j)
        trace(i * ny + j) = scale * std::sin(k * pi * (i + 0.5) / nx) * std::sin(l * pi * (j + 0.5) / ny);
    if (n >= static_cast<std::size_t>(modes)) {
      others.col(static_cast<Eigen::Index>(n) - modes) = trace / omega;
      continue;
    }
    // ∫ φ ds. The pressure is chosen so that the lowest mode alone would sag by `sag` in the middle.
    const bool odd = k % 2 == 1 && l % 2 == 1;
    const double participation = odd ? scale * 4 * a * b / (pi * pi * k * l) : 0;
    if (n == 0) pressure = sag * omega * omega / (scale * participation);
    for (const int plate : {0, 1}) {
      const Eigen::Index column = plate * modes + static_cast<Eigen::Index>(n);
      model.omega(column) = omega;
      model.decay(column) = decay;
      model.B.col(column) = plate == 0 ? trace : -trace;
      if (plate == 0) model.load(column) = pressure * participation;
    }
  }
  model.R = 2 * others * others.transpose();  // R of both plates
  return model;
}

}  // namespace ricochet::benchmarks
