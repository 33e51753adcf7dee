// SPDX-License-Identifier: BSD-2-Clause
// A body with random modes that faces the floor, in the form in which embedding programs pass bodies.
#pragma once

#include <cmath>
#include <memory>
#include <random>
#include <utility>

#include "ricochet/ricochet.hpp"
#include "tests/contact/bodies.hpp"

namespace ricochet::contact::test {

struct Plate {
  int modes = 12;             ///< including the rigid mode along z
  int points = 3;             ///< at x = 0, 1, …, facing −z
  double mass = 2;            ///< [kg]
  double ratio = 0;           ///< damping ratio
  double rigid_decay = 0;     ///< decay rate of the rigid mode [1/s]
  bool supported = false;     ///< no rigid mode if true
  double flexibility = 1e-7;  ///< R of each point [m/N]
};

inline SharedKernel shared(kernels::Kernel kernel) {
  kernel.hash = kernel.body;
  kernel.modes.residual.assign(kernel.modes.size(), 0);
  return std::make_shared<const kernels::Kernel>(std::move(kernel));
}

inline SharedKernel plate(const Plate& options) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> spread(-1, 1);
  const std::size_t n = static_cast<std::size_t>(options.modes), m = static_cast<std::size_t>(options.points);
  kernels::Kernel kernel;
  kernel.body = "plate";
  kernel.mass = options.mass;
  kernel.supported = options.supported;
  kernels::Surface& surface = kernel.surface;
  surface.components = 1;
  surface.direction = Vector3{0, 0, 1};
  surface.element_corners = m > 1 ? 2 : 1;
  for (std::size_t i = 0; i < m; ++i) {
    add_candidate(kernel, {static_cast<double>(i), 0, 0}, {0, 0, -1}, 1);
    if (m == 1) surface.element = {0};
    if (i > 0) surface.element.insert(surface.element.end(), {std::int64_t(i) - 1, std::int64_t(i)});
  }
  surface.shape.resize(m * n);
  kernel.loads.body_force.assign(3 * n, 0);
  kernel.loads.rotation.assign(3 * n, 0);
  for (std::size_t k = 0; k < n; ++k) {
    const bool rigid = k == 0 && !options.supported;
    const double omega = rigid ? 0 : 300.0 * static_cast<double>(options.supported ? k + 1 : k);
    kernel.modes.angular_frequency.push_back(omega);
    kernel.modes.decay_rate.push_back(rigid ? options.rigid_decay : options.ratio * omega);
    for (std::size_t i = 0; i < m; ++i)
      surface.shape[i * n + k] = rigid ? 1 / std::sqrt(options.mass) : spread(random);
    if (rigid) kernel.loads.body_force[2 * n] = std::sqrt(options.mass);
  }
  surface.residual_flexibility.assign(m * m, 0);
  for (std::size_t i = 0; i < m; ++i) surface.residual_flexibility[i * m + i] = options.flexibility;
  return shared(std::move(kernel));
}

/// The plate above a floor at z = 0, falling.
inline Scene falling(const Plate& options, double gap, double speed, double gravity) {
  Scene scene;
  scene.bodies = {{.name = "plate", .kernel = plate(options), .velocity = {0, 0, -speed}}};
  scene.obstacles = {{.name = "floor", .normal = {0, 0, 1}}};
  scene.pairs = {{.a = "plate", .b = "floor", .gap = gap}};
  scene.pickups = {{.body = "plate", .direction = {0, 0, 1}}};
  scene.gravity = {0, 0, -gravity};
  return scene;
}

}  // namespace ricochet::contact::test
