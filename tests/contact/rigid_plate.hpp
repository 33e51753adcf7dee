// SPDX-License-Identifier: BSD-2-Clause
// A rigid body with its six rigid modes.
#pragma once

#include "tests/contact/bodies.hpp"

namespace ricochet::contact::test {

/// A free rigid plate on the unit square that faces −z, with its six rigid modes (mass 1, inertia 1 about its
/// centre). Its 9 candidates are 0.5 m apart.
inline kernels::Kernel rigid_plate() {
  kernels::Kernel kernel = square(2, 2);
  for (double& z : kernel.surface.normal) z = -z;
  kernel.centre = {0.5, 0.5, 0};
  kernel.inertia = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  kernel.modes.angular_frequency.assign(6, 0);
  kernel.modes.decay_rate.assign(6, 0);
  const auto field = [](int n, const Vector3d& x) -> Vector3d {
    const Vector3d arm = x - Vector3d(0.5, 0.5, 0);
    return n < 3 ? Vector3d::Unit(n) : Vector3d(Vector3d::Unit(n - 3).cross(arm));
  };
  for (std::size_t i = 0; i < kernel.surface.size(); ++i)
    for (int k = 0; k < 3; ++k)
      for (int n = 0; n < 6; ++n)
        kernel.surface.shape.push_back(field(n, Eigen::Map<const Vector3d>(&kernel.surface.node[3 * i]))(k));
  for (int k = 0; k < 3; ++k)
    for (int n = 0; n < 6; ++n) {
      kernel.loads.body_force.push_back(n == k ? 1 : 0);
      // Angular momentum about the origin: centre × p for translations, the inertia for rotations.
      const Vector3d about =
          n < 3 ? Vector3d(0.5, 0.5, 0).cross(Vector3d::Unit(n)) : Vector3d(Vector3d::Unit(n - 3));
      kernel.loads.rotation.push_back(about(k));
    }
  return kernel;
}

/// The same with a spring of its own behind each candidate. @param flexibility  in each direction [m/N]
inline kernels::Kernel rigid_plate_on_springs(double flexibility) {
  kernels::Kernel kernel = rigid_plate();
  kernel.body = "plate";
  const std::size_t rows = 3 * kernel.surface.size();
  kernel.surface.residual_flexibility.assign(rows * rows, 0);
  for (std::size_t k = 0; k < rows; ++k) kernel.surface.residual_flexibility[k * rows + k] = flexibility;
  kernel.loads.body_force_residual.assign(3 * rows, 0);
  return kernel;
}

}  // namespace ricochet::contact::test
