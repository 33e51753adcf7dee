// SPDX-License-Identifier: BSD-2-Clause
// Models with friction, made by hand.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>

#include "contact/model/model.hpp"

namespace ricochet::contact::test {

/// m points with friction and N modes, without motion, loads or R.
inline Model sliding(int m, int N, const Friction& law) {
  Model model;
  const int rows = 3 * m;
  for (Vector* x : {&model.omega, &model.decay, &model.load, &model.q0, &model.v0}) x->setZero(N);
  for (Vector* x : {&model.gap, &model.area}) x->setZero(m);
  for (Vector* x : {&model.static_displacement, &model.static_a}) x->setZero(rows);
  model.B.setZero(rows, N);
  model.R.setZero(rows, rows);
  model.R_a = model.R;
  for (int i = 0; i < m; ++i) model.friction.push_back({i, m + 2 * i, law});
  return model;
}

/// One point that is pressed by exactly `force` [N] at all times: its normal row moves by R alone. The first
/// tangential row belongs to the modes.
/// @param flexibility  R of each row [m/N]
inline Model pressed(int N, const Friction& law, double force, double flexibility) {
  Model model = sliding(1, N, law);
  model.R.diagonal().setConstant(flexibility);
  model.static_displacement(0) = flexibility * force;
  return model;
}

/// A random body with up to three rigid modes, one for each row of a point, and elastic ones that couple all
/// rows. It flies towards a floor below all points.
struct RandomBody {
  int points = 1, modes = 6;
  double friction = 0.3;
  double flexibility = 1e-3;  ///< of R; 0 for none
  double frequency = 10;      ///< distance of the modes [rad/s]
  double damping = 0;         ///< ratio
};
inline Model random_body(const RandomBody& of, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const int m = of.points, N = of.modes, rows = 3 * m, rigid = std::min(3, N);
  Model model = sliding(m, N, {of.friction, of.friction, 0});
  for (int n = 3; n < N; ++n) {
    model.omega(n) = of.frequency * (n - 2) * (0.5 + uniform(random));
    model.decay(n) = of.damping * model.omega(n);
  }
  for (int i = 0; i < rows; ++i)
    for (int n = 3; n < N; ++n) model.B(i, n) = normal(random);
  for (int i = 0; i < m; ++i)
    for (int k = 0; k < rigid; ++k) model.B(k == 0 ? i : m + 2 * i + k - 1, k) = 1;
  if (of.flexibility > 0) {
    const Matrix A = Matrix::NullaryExpr(rows, rows, [&] { return normal(random); });
    model.R = of.flexibility * (A * A.transpose() / rows + 0.1 * Matrix::Identity(rows, rows));
  }
  for (double& g : model.gap) g = 0.01 * uniform(random);
  for (int k = 0; k < rigid; ++k) model.v0(k) = k == 0 ? 1 : normal(random);
  return model;
}

}  // namespace ricochet::contact::test
