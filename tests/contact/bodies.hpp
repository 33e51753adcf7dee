// Bodies small enough to know everything about: surfaces without modes, and rods with their exact ones.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "contact/model.hpp"
#include "kernels/error.hpp"
#include "tests/support.hpp"

namespace ricochet::contact::test {

using ricochet::test::complaint_of;

using Eigen::Matrix3d;
using Eigen::Vector3d;

inline void add_candidate(kernels::Kernel& kernel, const Vector3d& x, const Vector3d& normal, double area) {
  kernels::Surface& surface = kernel.surface;
  const Vector3d n = normal.normalized();
  surface.node.insert(surface.node.end(), {x.x(), x.y(), x.z()});
  surface.normal.insert(surface.normal.end(), {n.x(), n.y(), n.z()});
  surface.group.push_back("skin");
  surface.area.push_back(area);
}

/// Unit square cut into nx × ny cells of two triangles each and bent by `shape`, which gives a point and its
/// normal.
inline kernels::Kernel sheet(int nx, int ny,
                             const std::function<std::pair<Vector3d, Vector3d>(double, double)>& shape) {
  kernels::Kernel kernel;
  kernel.mass = 1;
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) {
      const auto [x, n] = shape(double(i) / nx, double(j) / ny);
      add_candidate(kernel, x, n, 1.0 / (nx * ny));
    }
  for (std::int64_t j = 0; j < ny; ++j)
    for (std::int64_t i = 0; i < nx; ++i) {
      const std::int64_t p = j * (nx + 1) + i, q = p + nx + 1;
      for (const std::int64_t corner : {p, p + 1, q, p + 1, q + 1, q})
        kernel.surface.element.push_back(corner);
    }
  return kernel;
}

/// Flat, in the plane z = 0, facing +z.
inline kernels::Kernel square(int nx, int ny) {
  return sheet(nx, ny, [](double s, double t) { return std::pair(Vector3d(s, t, 0), Vector3d(0, 0, 1)); });
}

/// Cap of a sphere around the origin, about its +z pole, out to 45 degrees at the edges' middles times
/// `width`.
inline kernels::Kernel cap(int n, double radius, double width = 1) {
  return sheet(n, n, [=](double s, double t) {
    const Vector3d way = Vector3d(width * (2 * s - 1), width * (2 * t - 1), 1).normalized();
    return std::pair<Vector3d, Vector3d>(radius * way, way);
  });
}

/// Turns +z into −z and keeps x.
inline Matrix3d upside_down() { return Vector3d(1, -1, -1).asDiagonal(); }

inline Matrix3d turn(double angle, const Vector3d& axis) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

/// Free rod along x with ρA = E A = 1, hence c = 1: modes √(2/L) cos(nπx/L), ends 0 (x = 0) and 1 (x = L).
inline kernels::Kernel rod(int modes, double length, bool residual = true) {
  kernels::Kernel kernel;
  kernel.body = "rod";
  kernel.mass = length;
  kernel.centre = {length / 2, 0, 0};
  const double inertia = std::pow(length, 3) / 12;
  kernel.inertia = {0, 0, 0, 0, inertia, 0, 0, 0, inertia};
  add_candidate(kernel, {0, 0, 0}, {-1, 0, 0}, 1);
  add_candidate(kernel, {length, 0, 0}, {1, 0, 0}, 1);
  kernels::Surface& surface = kernel.surface;
  surface.components = 1;
  surface.direction = Vector3{1, 0, 0};
  surface.element_corners = 1;
  surface.element = {0, 1};
  const auto frequency = [&](int n) { return n * std::numbers::pi / length; };
  for (int n = 0; n < modes; ++n) kernel.modes.angular_frequency.push_back(frequency(n));
  kernel.modes.decay_rate.assign(static_cast<std::size_t>(modes), 0);
  for (int end = 0; end < 2; ++end)
    for (int n = 0; n < modes; ++n)
      surface.shape.push_back(std::sqrt((n == 0 ? 1 : 2) / length) * (end == 1 && n % 2 == 1 ? -1 : 1));
  if (residual) {
    double same = 0, opposite = 0;
    for (int n = modes; n < 1'000'000; ++n) {
      const double term = 2 / length / (frequency(n) * frequency(n));
      same += term;
      opposite += n % 2 == 1 ? -term : term;
    }
    surface.residual_flexibility = {same, opposite, opposite, same};
    kernel.loads.body_force_residual.assign(6, 0);
  }
  kernel.loads.body_force.assign(3 * static_cast<std::size_t>(modes), 0);
  kernel.loads.body_force[0] = std::sqrt(length);
  kernel.loads.rotation.assign(3 * static_cast<std::size_t>(modes), 0);
  return kernel;
}

}  // namespace ricochet::contact::test
