// SPDX-License-Identifier: BSD-2-Clause
// Bodies simple enough for closed-form results: surfaces without modes, and rods with their exact modes.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "contact/model/model.hpp"
#include "ricochet/error.hpp"
#include "tests/contact/names.hpp"
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

/// Unit square divided into nx × ny cells of two triangles each. `shape` maps the coordinates
/// in the square to a point and its normal.
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

/// Flat sheet in the plane z = 0 that faces +z.
inline kernels::Kernel square(int nx, int ny) {
  return sheet(nx, ny, [](double s, double t) { return std::pair(Vector3d(s, t, 0), Vector3d(0, 0, 1)); });
}

/// Spherical cap around the +z pole, centred at the origin. The middles of its edges lie at an
/// angle of arctan(`width`) from the pole.
inline kernels::Kernel cap(int n, double radius, double width = 1) {
  return sheet(n, n, [=](double s, double t) {
    const Vector3d way = Vector3d(width * (2 * s - 1), width * (2 * t - 1), 1).normalized();
    return std::pair<Vector3d, Vector3d>(radius * way, way);
  });
}

/// Rotation that maps +z to −z and keeps x.
inline Matrix3d upside_down() { return Vector3d(1, -1, -1).asDiagonal(); }

inline Matrix3d turn(double angle, const Vector3d& axis) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

/// Free rod along x with ρA = EA = 1, hence c = 1. Modes √(2/L) cos(nπx/L);
/// candidates 0 (x = 0) and 1 (x = L).
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

/// Bar along x, clamped at x = 0, with ρA = EA = c = 1 and modes φ_n = √(2/L) sin((n + ½)πx/L). Both ends are
/// candidates. The motion "foot" moves the foot along x, the load "tip" pulls at the free end, and the
/// receiver "mic" is in the middle. Residuals are the static response of the bar minus that of its modes.
inline kernels::Kernel clamped_bar(int modes, double length) {
  kernels::Kernel kernel = rod(1, length, false);
  kernel.supported = true;
  const auto wave = [&](int n) { return (n + 0.5) * std::numbers::pi / length; };
  const auto phi = [&](int n, double x) { return std::sqrt(2 / length) * std::sin(wave(n) * x); };
  const auto sum = [&](int n) { return std::sqrt(2 / length) / wave(n); };
  kernel.modes.angular_frequency.clear();
  kernel.surface.shape.clear();
  kernel.loads.body_force.assign(3 * static_cast<std::size_t>(modes), 0);
  kernel.loads.rotation.assign(3 * static_cast<std::size_t>(modes), 0);
  for (int n = 0; n < modes; ++n) {
    kernel.modes.angular_frequency.push_back(wave(n));
    kernel.loads.body_force[n] = sum(n);
  }
  kernel.modes.decay_rate.assign(static_cast<std::size_t>(modes), 0);
  for (const double x : {0.0, length})
    for (int n = 0; n < modes; ++n) kernel.surface.shape.push_back(phi(n, x));
  // Statics: a unit force at y displaces x by min(x, y), the weight of
  // the bar by x (2L − x)/2; the lift is 1.
  const auto rest = [&](double x, double y) {
    double out = std::min(x, y);
    for (int n = 0; n < modes; ++n) out -= phi(n, x) * phi(n, y) / (wave(n) * wave(n));
    return out;
  };
  const auto sag = [&](double x) {
    double out = x * (2 * length - x) / 2;
    for (int n = 0; n < modes; ++n) out -= phi(n, x) * sum(n) / (wave(n) * wave(n));
    return out;
  };
  const auto lift = [&](double x) {
    double out = 1;
    for (int n = 0; n < modes; ++n) out -= phi(n, x) * sum(n);
    return out;
  };
  kernel.surface.residual_flexibility = {0, 0, 0, rest(length, length)};
  kernel.loads.body_force_residual = {0, 0, 0, sag(length), 0, 0};
  double momentum = length;
  for (int n = 0; n < modes; ++n) momentum -= sum(n) * sum(n);
  kernels::Motion foot{"foot", kernel.loads.body_force, {lift(0), 0, 0, lift(length), 0, 0}, {}};
  foot.momentum = {momentum, 0, 0, 0, 0, 0, 0, 0, 0};
  kernel.motions = {foot};
  // A force along x at the tip.
  kernels::Load tip{"tip", "N", {}, {1, 0, 0, 0, 0, 0, 0, 0, 0}, std::vector<double>(9, 0), {}};
  for (int n = 0; n < modes; ++n) tip.participation.push_back(phi(n, length));
  tip.participation.resize(3 * static_cast<std::size_t>(modes), 0);
  tip.residual = {0, 0, 0, rest(length, length), 0, 0};
  kernel.applied = {tip};
  const double middle = length / 2;
  kernels::Receiver mic{"mic", {middle, 0, 0}, {}, {}, {}, {}, {}};
  for (int n = 0; n < modes; ++n) mic.shape.push_back(phi(n, middle));
  mic.shape.resize(3 * static_cast<std::size_t>(modes), 0);
  mic.residual_flexibility = {0, rest(middle, length), 0, 0, 0, 0};
  mic.body_force_residual = {sag(middle), 0, 0, 0, 0, 0, 0, 0, 0};
  mic.load_residual = {rest(middle, length), 0, 0, 0, 0, 0, 0, 0, 0};
  mic.motion_residual = {lift(middle), 0, 0, 0, 0, 0, 0, 0, 0};
  kernel.receivers = {mic};
  return kernel;
}

}  // namespace ricochet::contact::test
