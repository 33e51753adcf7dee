// SPDX-License-Identifier: BSD-2-Clause
#include "kernels/expected_modes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace ricochet::kernels {

namespace {

constexpr double pi = std::numbers::pi;

/// Shear coefficient of bending, with which the cutoff of thickness shear is exact (Mindlin 1951).
constexpr double shear_coefficient = pi * pi / 12;

/// The smallest side of a box, relative to the longest: the inertia of thinner ones is round-off.
constexpr double thinnest = 1e-6;

/// The sides of the box, ascending [m].
Eigen::Vector3d sides_of(double mass, std::span<const double> inertia) {
  const Eigen::Vector3d principal =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(Eigen::Map<const Eigen::Matrix3d>(inertia.data()))
          .eigenvalues();
  Eigen::Vector3d side;
  for (int k = 0; k < 3; ++k)
    side[k] = std::sqrt(std::max(6 / mass * (principal.sum() - 2 * principal[k]), 1e-300));
  std::sort(side.begin(), side.end());
  return side;
}

/// Both sides of a rectangle with this area and half of this perimeter, the longer one first. If there is
/// none, because the section is round, those of a square with the same area.
std::pair<double, double> sides_of(double area, double half_perimeter) {
  const double square = half_perimeter * half_perimeter / 4 - area;
  if (square <= 0) return {std::sqrt(area), std::sqrt(area)};
  const double longer = half_perimeter / 2 + std::sqrt(square);
  return {longer, area / longer};
}

/// Speed of torsion relative to that of shear, √(J/I_p), in a bar with a rectangular section, w ≥ t (Roark).
double torsion(double w, double t) {
  const double r = t / w, twist = w * t * t * t * (1 - 0.63 * r * (1 - r * r * r * r / 12)) / 3;
  return std::sqrt(twist / (w * t * (w * w + t * t) / 12));
}

}  // namespace

Extent box_of(double mass, std::span<const double> inertia) {
  Eigen::Vector3d side = sides_of(mass, inertia);
  if (side[1] < thinnest * side[2]) return {.length = side[2]};
  side = side.cwiseMax(thinnest * side[2]);
  return {side.prod(), 2 * (side[0] * side[1] + side[1] * side[2] + side[2] * side[0]), side[2]};
}

ExpectedCount expected_count(const Extent& extent, double wave_speed, double poisson) {
  const auto [V, S, l] = extent;
  const double c = wave_speed;
  if (S <= 0) return [l, c](double lambda) { return l * std::sqrt(lambda) / (pi * c); };
  // Squares of slownesses: of shear, and of stretching in a rod and in a plate.
  const double shear = 2 * (1 + poisson) / (c * c), rod = 1 / (c * c),
               plate = (1 - poisson * poisson) / (c * c), slow = shear / shear_coefficient;
  const auto bending = [slow](double lambda, double stretch, double thickness) {  // k_b²
    return lambda * (stretch + slow) / 2 + std::sqrt(std::pow(lambda * (stretch - slow) / 2, 2) +
                                                     12 * lambda * stretch / (thickness * thickness));
  };
  const double alpha = (1 - 2 * poisson) / (2 * (1 - poisson));
  const double bulk = V * (2 + std::pow(alpha, 1.5)) / (6 * pi * pi),
               skin = S * (3 - 3 * alpha + 2 * alpha * alpha) / (16 * pi * (1 - alpha)), h = 2 * V / S;
  const auto [w, t] = sides_of(V / l, (S / 2 - V / l) / l);
  const double along = std::sqrt(rod) + std::sqrt(shear) / torsion(w, t);
  return [=](double lambda) {
    const double k2 = shear * lambda, solid = (bulk * std::sqrt(k2) + skin) * k2,
                 thin = S / (8 * pi) * (bending(lambda, plate, h) + plate * lambda + k2),
                 slender = l / pi *
                           (std::sqrt(bending(lambda, rod, w)) + std::sqrt(bending(lambda, rod, t)) +
                            along * std::sqrt(lambda));
    return std::max({solid, thin, slender});
  };
}

}  // namespace ricochet::kernels
