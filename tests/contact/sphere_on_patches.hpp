// SPDX-License-Identifier: BSD-2-Clause
// A rigid sphere on an elastic half-space, on one patch and on many, with Hertz's values.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "contact/model/model.hpp"
#include "tests/contact/falling_body.hpp"

namespace ricochet::contact::test {

/// A sphere on an elastic half-space, in units of the spacing of its candidates, and its only patch: the hat
/// (1 − |x|)(1 − |y|) around the point of contact. Forces are in units of E* h².
struct SphereOnPatch {
  double radius = 20;

  /// Mean of (x² + y²)/2R over the hat: ∫ x² (1 − |x|) dx = 1/6 along each axis.
  double bulge() const { return 1 / (6 * radius); }
  /// Boussinesq: a unit force at the distance r displaces the surface by 1/(π E* r). Mean of that over the
  /// hat at (x, y) for a force distributed like the hat at the origin. The correlation of two hats is the
  /// cubic B-spline.
  static double flexibility(double x = 0, double y = 0) {
    const auto spline = [](double t) {
      t = std::abs(t);
      return t < 1 ? 2.0 / 3 - t * t + t * t * t / 2 : t < 2 ? std::pow(2 - t, 3) / 6 : 0;
    };
    const double distance = std::hypot(x, y), reach = distance + std::sqrt(8);
    if (distance > 4) return 1 / (std::numbers::pi * distance);  // to 1 %
    const int rings = 300, rays = 256;
    double sum = 0;
    for (int i = 0; i < rings; ++i)
      for (int k = 0; k < rays; ++k) {
        const double r = reach * (i + 0.5) / rings, angle = 2 * std::numbers::pi / rays * (k + 0.5);
        sum += spline(r * std::cos(angle) - x) * spline(r * std::sin(angle) - y);
      }
    return sum * (reach / rings) * (2 * std::numbers::pi / rays) / std::numbers::pi;
  }
  /// Hertz: F = 4/3 √R δ^(3/2).
  double force(double approach) const { return 4.0 / 3 * std::sqrt(radius) * std::pow(approach, 1.5); }
  /// F/δ^(3/2) of the spring and R, from R λ + s = 3 b^(1/3) (R λ/2)^(2/3).
  double law() const { return 2 / flexibility() / std::sqrt(27 * bulge()); }
  /// Approach at which λ R_ii = 2b.
  double filled() const { return 3 * bulge(); }
};

/// A rigid sphere of unit mass that falls on many patches.
/// @param aside  whether it meets the half-space between four candidates, otherwise at one
/// @param farthest  distance of the candidates from there
inline Model sphere_on_patches(double radius, double farthest, bool aside, double speed) {
  const int reach = static_cast<int>(farthest) + 1;
  const double middle = aside ? 0.5 : 0;
  std::vector<Eigen::Vector2i> at;
  for (int x = -reach; x <= reach; ++x)
    for (int y = -reach; y <= reach; ++y)
      if (std::hypot(x - middle, y - middle) <= farthest) at.emplace_back(x, y);
  Eigen::MatrixXd by_distance(2 * reach + 2, 2 * reach + 2);
  for (int x = 0; x < by_distance.rows(); ++x)
    for (int y = 0; y <= x; ++y) by_distance(x, y) = by_distance(y, x) = SphereOnPatch::flexibility(x, y);
  const auto m = static_cast<Eigen::Index>(at.size());
  Model model = blank(1, m);
  model.B.setOnes();
  model.point_a.setZero(m, 3);
  model.normal = -Eigen::RowVector3d::UnitZ().replicate(m, 1);
  model.v0(0) = speed;
  model.bulge = Vector::Constant(m, SphereOnPatch{radius}.bulge());
  for (Eigen::Index i = 0; i < m; ++i) {
    const Eigen::Vector2i x = at[static_cast<std::size_t>(i)];
    model.point_a.row(i) << x.cast<double>().transpose(), 0;
    model.gap(i) = (x.cast<double>().array() - middle).matrix().squaredNorm() / (2 * radius);
    for (Eigen::Index j = 0; j < m; ++j) {
      const Eigen::Vector2i d = (x - at[static_cast<std::size_t>(j)]).cwiseAbs();
      model.R(i, j) = by_distance(d.x(), d.y());
    }
  }
  return model;
}

/// Its blow, with `across` candidates across the contact radius at the largest approach. Hertz: ½ m v² = 2/5
/// F δ there, and the contact lasts 2.9432 δ/v.
struct SphereOnPatches {
  static constexpr double radius = 1e4;
  double speed, peak, duration;
  Model model;

  SphereOnPatches(double across, bool aside) {
    const double K = 4.0 / 3 * std::sqrt(radius), approach = across * across / radius;
    speed = std::sqrt(0.8 * K * std::pow(approach, 2.5));
    peak = K * std::pow(approach, 1.5);
    duration = 2.9432 * approach / speed;
    model = sphere_on_patches(radius, 1.15 * across + 1.6, aside, speed);
  }
};

}  // namespace ricochet::contact::test
