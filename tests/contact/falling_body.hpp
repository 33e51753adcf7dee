// SPDX-License-Identifier: BSD-2-Clause
// Models without meshes for tests of steppers: an empty one, and a body that falls on a rigid half-space.
#pragma once

#include <cmath>
#include <random>

#include "contact/model/model.hpp"
#include "tests/contact/names.hpp"

namespace ricochet::contact::test {

inline Model blank(Eigen::Index modes, Eigen::Index points) {
  Model model;
  model.omega = model.decay = model.load = model.q0 = model.v0 = Vector::Zero(modes);
  model.B = Matrix::Zero(points, modes);
  model.R = Matrix::Zero(points, points);
  model.gap = model.static_displacement = Vector::Zero(points);
  model.area = Vector::Ones(points);
  return model;
}

inline constexpr double gravity = 9.81, mass = 2;

/// A body above a rigid half-space under its weight, with one rigid mode
/// towards it and `modes` − 1 elastic modes.
inline Model dropped(Eigen::Index modes, Eigen::Index points, double gap, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> spread(-1, 1);
  Model model = blank(modes, points);
  model.B.col(0).setConstant(1 / std::sqrt(mass));
  model.load(0) = std::sqrt(mass) * gravity;
  model.gap.setConstant(gap);
  for (Eigen::Index n = 1; n < modes; ++n) {
    model.omega(n) = 300.0 * static_cast<double>(n);
    for (Eigen::Index i = 0; i < points; ++i) model.B(i, n) = spread(random);
  }
  for (Eigen::Index i = 0; i < points; ++i) model.R(i, i) = 1e-7;
  model.has_residual = true;
  return model;
}

}  // namespace ricochet::contact::test
