// SPDX-License-Identifier: BSD-2-Clause
// Rigid bodies over a floor on which they may turn by any angle.
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "tests/contact/cloud.hpp"

namespace ricochet::contact::test {

/// A rigid body with candidates that rest on springs, and nothing else.
inline kernels::Kernel rigid_body(double mass, const Vector3d& moments, const std::vector<Vector3d>& points,
                                  double flexibility) {
  kernels::Kernel kernel;
  kernel.body = "body";
  kernel.mass = mass;
  kernel.inertia = {moments.x(), 0, 0, 0, moments.y(), 0, 0, 0, moments.z()};
  kernel.modes.angular_frequency.assign(6, 0);
  kernel.modes.decay_rate.assign(6, 0);
  const auto field = [&](int n, const Vector3d& x) -> Vector3d {
    return n < 3 ? Vector3d(Vector3d::Unit(n) / std::sqrt(mass))
                 : Vector3d(Vector3d::Unit(n - 3).cross(x) / std::sqrt(moments(n - 3)));
  };
  for (const Vector3d& point : points) {
    add_candidate(kernel, point, point.normalized(), 1e-6);
    for (int axis = 0; axis < 3; ++axis)
      for (int n = 0; n < 6; ++n) kernel.surface.shape.push_back(field(n, point)(axis));
    kernel.surface.element.push_back(std::ssize(kernel.surface.element));
  }
  kernel.surface.element_corners = 1;
  for (int axis = 0; axis < 3; ++axis)
    for (int n = 0; n < 6; ++n) {
      kernel.loads.body_force.push_back(n == axis ? std::sqrt(mass) : 0);
      kernel.loads.rotation.push_back(n == axis + 3 ? std::sqrt(moments(axis)) : 0);
    }
  const auto size = 3 * points.size();
  kernel.surface.residual_flexibility.assign(size * size, 0);
  for (std::size_t k = 0; k < size; ++k) kernel.surface.residual_flexibility[k * size + k] = flexibility;
  return kernel;
}

inline std::shared_ptr<const Model> over_floor(const kernels::Kernel& kernel, PlacedBody body,
                                               const Friction& friction, const Vector3d& gravity,
                                               double gap = 0) {
  body.name = "body";
  body.kernel = &kernel;
  PairRequest pair{"body", "floor", {}, gap, {}};
  pair.friction = friction;
  pair.everywhere = true;
  return std::make_shared<const Model>(
      build_model({body}, {{.name = "floor", .normal = Vector3d::UnitZ()}}, {pair}, gravity));
}

}  // namespace ricochet::contact::test
