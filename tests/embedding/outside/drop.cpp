// SPDX-License-Identifier: BSD-2-Clause
// Drops a rigid bob through the C++ header, compares with Galilei's law, and writes the kernels for drop.c
// and for the manual: of the bob, of a rigid ball that turns, and of a die.
#include <ricochet/ricochet.hpp>

#if defined(EIGEN_WORLD_VERSION) || defined(MPI_VERSION) || defined(H5_VERS_MAJOR) || defined(FMT_VERSION)
#error "ricochet.hpp brings in a library that its users did not ask for"
#endif
#if defined(_XMMINTRIN_H_INCLUDED) || defined(_IMMINTRIN_H_INCLUDED) || defined(__ARM_NEON_H)
#error "ricochet.hpp brings in SIMD types"
#endif

#include <cmath>
#include <cstdio>
#include <iostream>

namespace {

int failures = 0;

void expect(bool holds, const char* what) {
  if (holds) return;
  std::cerr << "not so: " << what << '\n';
  ++failures;
}

/// A mass of 4 kg on a spring of 1e5 N/m that moves along z.
ricochet::kernels::Kernel bob() {
  ricochet::kernels::Kernel kernel;
  kernel.body = kernel.hash = "bob";
  kernel.mass = 4;
  kernel.modes.angular_frequency = kernel.modes.decay_rate = kernel.modes.residual = {0};
  kernel.modes.certificate.count_found = kernel.modes.certificate.count_by_inertia = 1;
  kernel.modes.certificate.complete = true;
  kernel.loads.body_force = {0, 0, 2};
  kernel.loads.rotation = {0, 0, 0};
  kernel.surface.components = 1;
  kernel.surface.direction = ricochet::Vector3{0, 0, 1};
  kernel.surface.node = {0, 0, 0};
  kernel.surface.normal = {0, 0, -1};
  kernel.surface.area = {1};
  kernel.surface.group = {"bottom"};
  kernel.surface.element_corners = 1;
  kernel.surface.element = {0};
  kernel.surface.shape = {0.5};
  kernel.surface.residual_flexibility = {1e-5};
  return kernel;
}

/// A rigid ball of 2 kg with a radius of 0.1 m, one contact point, on a spring of 1e6 N/m, and a point force
/// at its centre.
ricochet::kernels::Kernel ball() {
  constexpr double mass = 2, inertia = 0.4 * mass * 0.01;
  const double linear = 1 / std::sqrt(mass), angular = 1 / std::sqrt(inertia);
  ricochet::kernels::Kernel kernel;
  kernel.body = kernel.hash = "ball";
  kernel.mass = mass;
  kernel.inertia = {inertia, 0, 0, 0, inertia, 0, 0, 0, inertia};
  kernel.modes.angular_frequency = kernel.modes.decay_rate = kernel.modes.residual = {0, 0, 0, 0, 0, 0};
  kernel.modes.certificate.count_found = kernel.modes.certificate.count_by_inertia = 6;
  kernel.modes.certificate.complete = true;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t n = 0; n < 6; ++n) {
      kernel.loads.body_force.push_back(n == axis ? std::sqrt(mass) : 0);
      kernel.loads.rotation.push_back(n == axis + 3 ? std::sqrt(inertia) : 0);
    }
  const double h = 0.1;  // rotations about x and y move the lowest point along y and −x
  kernel.surface.node = {0, 0, -h};
  kernel.surface.normal = {0, 0, -1};
  kernel.surface.area = {1};
  kernel.surface.group = {"skin"};
  kernel.surface.element_corners = 1;
  kernel.surface.element = {0};
  kernel.surface.shape = {linear, 0, 0, 0, -h * angular, 0, 0, linear, 0, h * angular,
                          0,      0, 0, 0, linear,       0, 0, 0};
  kernel.surface.residual_flexibility = {1e-6, 0, 0, 0, 1e-6, 0, 0, 0, 1e-6};
  kernel.loads.body_force_residual.assign(9, 0);
  kernel.applied = {{.name = "push",
                     .unit = "N",
                     .participation = {linear, 0, 0, 0, 0, 0, 0, linear, 0, 0, 0, 0, 0, 0, linear, 0, 0, 0},
                     .total = {1, 0, 0, 0, 1, 0, 0, 0, 1},
                     .moment = std::vector<double>(9, 0),
                     .residual = std::vector<double>(9, 0)}};
  return kernel;
}

/// The ball as an octahedron of 0.1 kg with a radius of 2 cm, whose corners are on springs.
ricochet::kernels::Kernel die() {
  constexpr double radius = 0.02, mass = 0.1, inertia = 0.2 * mass * radius * radius;
  const double linear = 1 / std::sqrt(mass), angular = 1 / std::sqrt(inertia);
  ricochet::kernels::Kernel kernel = ball();
  kernel.body = kernel.hash = "die";
  kernel.mass = mass;
  kernel.inertia = {inertia, 0, 0, 0, inertia, 0, 0, 0, inertia};
  kernel.loads.body_force.clear();
  kernel.loads.rotation.clear();
  kernel.applied.clear();
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t n = 0; n < 6; ++n) {
      kernel.loads.body_force.push_back(n == axis ? std::sqrt(mass) : 0);
      kernel.loads.rotation.push_back(n == axis + 3 ? std::sqrt(inertia) : 0);
    }
  ricochet::kernels::Surface& surface = kernel.surface = {};
  surface.components = 3;
  surface.element_corners = 3;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const double side : {1.0, -1.0}) {
      ricochet::Vector3 normal{};
      normal[axis] = side;
      for (const double x : normal) {
        surface.node.push_back(radius * x);
        surface.normal.push_back(x);
      }
      surface.area.push_back(1e-4);
      surface.group.push_back("skin");
      const double x = radius * normal[0], y = radius * normal[1], z = radius * normal[2];
      for (const double entry : {linear, 0., 0., 0., z * angular, -y * angular,  //
                                 0., linear, 0., -z * angular, 0., x * angular,  //
                                 0., 0., linear, y * angular, -x * angular, 0.})
        surface.shape.push_back(entry);
    }
  for (const double x : {1, -1})
    for (const double y : {1, -1})
      for (const double z : {1, -1}) {
        const std::int64_t i = x > 0 ? 0 : 1, j = y > 0 ? 2 : 3, k = z > 0 ? 4 : 5;
        const bool swaps = x * y * z < 0;  // corners go round against the clock, seen from outside
        for (const std::int64_t corner : {i, swaps ? k : j, swaps ? j : k}) {
          surface.element.push_back(corner);
          for (const double component : {x, y, z})
            surface.element_normal.push_back(component / std::sqrt(3.0));
        }
      }
  surface.residual_flexibility.assign(18 * 18, 0);
  for (std::size_t i = 0; i < 18; ++i) surface.residual_flexibility[19 * i] = 1e-7;
  kernel.loads.body_force_residual.assign(3 * 18, 0);
  return kernel;
}

}  // namespace

int main(int, char** arguments) {
  ricochet::save_kernel(bob(), arguments[1]);
  ricochet::save_kernel(ball(), arguments[2]);
  ricochet::save_kernel(die(), arguments[3]);

  ricochet::Scene scene;
  scene.rate_hz = 1000;
  scene.bodies = {{.name = "bob", .kernel = ricochet::load_kernel(arguments[1])}};
  scene.obstacles = {{.name = "floor", .normal = {0, 0, 1}}};
  scene.pairs = {{.a = "bob", .b = "floor", .gap = 1.0}};
  scene.pickups = {{.body = "bob", .direction = {0, 0, -1}}};
  scene.gravity = {0, 0, -9.81};
  ricochet::Simulation simulation(scene);
  std::vector<double> velocity(400);
  expect(simulation.step_block(400, {.velocity = velocity.data()}).steps == 400, "it makes 400 steps");
  expect(std::abs(velocity.back() - 9.81 * 0.4) < 1e-12, "v = g t");
  expect(std::abs(simulation.displacement()[0] - 0.5 * 9.81 * 0.16) < 1e-12, "s = g t² / 2");
  double mean = 0;
  for (int k = 0; k < 19600; ++k) {
    expect(simulation.step() == ricochet::StepStatus::ok, "it goes on");
    mean += simulation.force()[0] / 20000;
  }
  // It bounces for ever, with 22 bounces in 20 s: a whole number of them carries m g exactly.
  expect(std::abs(mean / (4 * 9.81) - 1) < 1.0 / 22, "the floor carries m g on average");

  try {
    ricochet::load_kernel("nowhere.h5");
    expect(false, "a missing file is refused");
  } catch (const ricochet::InputError& error) {
    expect(std::string(error.what()).find("nowhere.h5") != std::string::npos, "the refusal names the file");
  }
  return failures;
}
