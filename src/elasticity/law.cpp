// SPDX-License-Identifier: BSD-2-Clause
#include "src/elasticity/law.hpp"

#include <cmath>
#include <numbers>

#include "src/scene/elastic_law.hpp"

namespace ricochet::elasticity {

namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Distance from the line, relative to the coordinates, that is round-off of a point on it.
constexpr double on_line = 1e-10;

Vector3d vector(const Vector3& v) { return Vector3d(v.data()); }

/// @param axes  its columns are the axes of the material
Matrix6 turned(const Matrix6& C, const Matrix3d& axes) {
  Matrix6 M;
  for (Index row = 0; row < 6; ++row)
    for (Index column = 0; column < 6; ++column) {
      const auto [i, j] = stress_order[static_cast<std::size_t>(row)];
      const auto [k, l] = stress_order[static_cast<std::size_t>(column)];
      M(row, column) = axes(i, k) * axes(j, l) + (k == l ? 0 : axes(i, l) * axes(j, k));
    }
  return M * C * M.transpose();
}

/// Radial, tangential and along the line.
Matrix3d axes_about(const Vector3d& line, const Vector3d& radial) {
  Matrix3d axes;
  axes << radial, line.cross(radial), line;
  return axes;
}

/// The mean over the directions around a line. Each entry of C is a trigonometric polynomial of degree 4, of
/// which the mean over eight equal steps is exact.
Matrix6 mean_around(const Matrix6& C, const Vector3d& line) {
  constexpr int steps = 8;
  const Vector3d start = line.unitOrthogonal();
  Matrix6 sum = Matrix6::Zero();
  for (int k = 0; k < steps; ++k) {
    const double angle = 2 * std::numbers::pi * k / steps;
    sum += turned(C, axes_about(line, std::cos(angle) * start + std::sin(angle) * line.cross(start)));
  }
  return sum / steps;
}

}  // namespace

Law::Law(const scene::Material& material) : about_(material.about) {
  const std::array<double, 36> rows = scene::stiffness_of(material);
  own_ = Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(rows.data());
  const Vector3d first = vector(material.axes[0]), second = vector(material.axes[1]);
  Matrix3d axes;
  axes << first, second, first.cross(second);
  fixed_ = about_ ? mean_around(own_, vector(about_->direction)) : turned(own_, axes);
}

Matrix6 Law::at(const Vector3d& point) const {
  if (!about_) return fixed_;
  const Vector3d line = vector(about_->direction), start = vector(about_->point), from = point - start,
                 radial = from - from.dot(line) * line;
  if (radial.norm() <= on_line * (point.norm() + start.norm())) return fixed_;
  return turned(own_, axes_about(line, radial.normalized()));
}

Eigen::Matrix<double, 9, 9> by_components(const Matrix6& C) {
  Eigen::Matrix<double, 9, 9> out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l) out(3 * i + k, 3 * j + l) = C(place_of(i, j), place_of(k, l));
  return out;
}

Eigen::Matrix<double, 6, 3> strain_of(const Vector3d& g) {
  Eigen::Matrix<double, 6, 3> out = Eigen::Matrix<double, 6, 3>::Zero();
  for (Index row = 0; row < 6; ++row) {
    const auto [i, j] = stress_order[static_cast<std::size_t>(row)];
    out(row, i) = g[j];
    out(row, j) = g[i];
  }
  return out;
}

}  // namespace ricochet::elasticity
