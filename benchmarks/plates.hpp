// SPDX-License-Identifier: BSD-2-Clause
// Two simply supported plates, one pressed on the other: persistent contact with modes in closed form, for
// any number of points and modes. With friction, their faces rub on each other as the plates bend.
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
/// @param friction  coefficient; 0 for no tangential rows
inline contact::Model plates(int nx, int ny, int modes, double decay = 20, double friction = 0) {
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
  const Eigen::Index m = nx * ny, N = 2 * modes, rows = friction > 0 ? 3 * m : m;
  for (contact::Vector* x : {&model.omega, &model.decay, &model.load, &model.q0, &model.v0}) x->setZero(N);
  model.B.setZero(rows, N);
  model.has_residual = true;
  model.gap.setConstant(m, gap);
  model.static_displacement.setZero(rows);
  model.area.setConstant(m, a * b / static_cast<double>(m));
  if (friction > 0)
    for (int i = 0; i < m; ++i)
      model.friction.push_back({i, static_cast<int>(m) + 2 * i, {friction, friction, 0}});
  contact::Vector trace(rows),
      lower(rows);  // of the lower face of the upper plate; of the other plate, relative
  Eigen::MatrixXd others(rows, 2 * static_cast<Eigen::Index>(all.size()) - modes);  // their traces over ω
  double pressure = 0;
  for (std::size_t n = 0; n < all.size(); ++n) {
    const auto& [omega, k, l] = all[n];
    const double scale = 2 / std::sqrt(area_mass * a * b);
    for (int i = 0; i < nx; ++i)
      for (int j = 0; j < ny; ++j) {
        const double x = k * pi * (i + 0.5) / nx, y = l * pi * (j + 0.5) / ny;
        trace(i * ny + j) = scale * std::sin(x) * std::sin(y);
        if (friction == 0) continue;
        // The faces move by half the thickness times the slope.
        trace(m + 2 * (i * ny + j)) = thickness / 2 * scale * (k * pi / a) * std::cos(x) * std::sin(y);
        trace(m + 2 * (i * ny + j) + 1) = thickness / 2 * scale * (l * pi / b) * std::sin(x) * std::cos(y);
      }
    lower = trace;
    lower.head(m) *= -1;
    if (n >= static_cast<std::size_t>(modes)) {
      const Eigen::Index column = 2 * (static_cast<Eigen::Index>(n) - modes);
      others.col(column) = trace / omega;
      others.col(column + 1) = lower / omega;
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
      model.B.col(column) = plate == 0 ? trace : lower;
      if (plate == 0) model.load(column) = pressure * participation;
    }
  }
  model.R.setZero(rows, rows);
  model.R.selfadjointView<Eigen::Lower>().rankUpdate(others);  // of both plates
  model.R.triangularView<Eigen::StrictlyUpper>() = model.R.transpose();
  return model;
}

}  // namespace ricochet::benchmarks
