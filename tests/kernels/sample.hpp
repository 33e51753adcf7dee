// SPDX-License-Identifier: BSD-2-Clause
// A small kernel with a distinct value in every field.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

#include "ricochet/error.hpp"
#include "ricochet/kernel.hpp"
#include "tests/support.hpp"

namespace ricochet::kernels::test {

using ricochet::test::complaint_of;
using ricochet::test::Folder;

inline std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline void put_bytes(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// @param components  3, or 1 for a kernel with a direction
inline Kernel sample_kernel(int components, std::size_t n = 5, std::size_t m = 4) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  const auto fill = [&](std::vector<double>& values, std::size_t count) {
    values.resize(count);
    for (double& value : values) value = normal(random);
  };
  const std::size_t c = static_cast<std::size_t>(components);
  Kernel kernel;
  kernel.body = "scheibe-\u00e4";
  kernel.hash = std::string(64, 'a');
  kernel.scene = "mesh = \"disk.msh\"\norder = 2\n" + std::string(50000, '#');
  kernel.mesh_sha256 = std::string(64, 'b');
  kernel.created_by = "ricochet-kernel 0.1.0";
  kernel.dofs = 5'000'000'000;
  kernel.elements = 321;
  kernel.order = 3;
  kernel.mass = 0.1;
  kernel.centre = {0.1, -0.2, 1.0 / 3};
  kernel.inertia = {1, 0.1, 0.2, 0.1, 2, 0.3, 0.2, 0.3, 3};
  kernel.supported = true;
  kernel.parts = 2;
  kernel.held_on_lines = 5;
  fill(kernel.outline, 3 * 4);
  kernel.piece_box = {-1, -2, -3, 0, 0, 1.0 / 3, 0.5, 0, 0, 2, 3, 4};
  kernel.piece_elements = {320, 1};

  Modes& modes = kernel.modes;
  for (std::size_t i = 0; i < n; ++i) {
    modes.angular_frequency.push_back(i == 0 ? 0.0 : 100.0 * std::sqrt(double(i)));
    modes.decay_rate.push_back(0.01 * double(i));
    modes.residual.push_back(1e-310 * double(i + 1));  // subnormal: survives only an exact copy
    for (std::size_t j = 0; j < n; ++j) modes.stiffness_error.push_back(1e-3 * double(i * j));
  }
  modes.certificate = {.below = 1,
                       .upto_hz = 1500.5,
                       .count_by_inertia = static_cast<std::int64_t>(n),
                       .shift = {0.5e4, 1e8},
                       .modes_below = {1, static_cast<double>(n) + 2},
                       .count_found = static_cast<std::int64_t>(n) + 2,
                       .left_out = 2,
                       .complete = true,
                       .orthonormality = 3e-14,
                       .flexibility_error = 1e-3};
  if (n > 4) modes.coriolis = {.pair = {1, 2, 3, 4}, .coupling = {0.1, -0.2, 0.3, 0.5, -0.0, 1e-310}};

  Surface& surface = kernel.surface;
  surface.components = components;
  if (components == 1) surface.direction = Vector3{0, -0.6, 0.8};
  fill(surface.node, 3 * m);
  fill(surface.centroid, 3 * m);
  fill(surface.bulge, m);
  for (std::size_t i = 0; i < m; ++i) {
    surface.group.push_back(i % 2 == 0 ? "rim" : "upper face");
    surface.normal.insert(surface.normal.end(), {std::cos(double(i)), -0.0, std::sin(double(i))});
    surface.area.push_back(1e-4 * double(i + 1));
    surface.mesh_error.push_back(1e-11 * double(i + 1));
  }
  surface.mesh_error_coupling = 0.125;
  surface.element_corners = 2;
  for (std::size_t i = 0; i + 1 < m; ++i) {
    surface.element.push_back(static_cast<std::int64_t>(i));
    surface.element.push_back(static_cast<std::int64_t>(i + 1));
    for (const double angle : {double(i), double(i) + 0.5})
      surface.element_normal.insert(surface.element_normal.end(), {std::cos(angle), std::sin(angle), 0});
  }
  fill(surface.shape, m * c * n);
  surface.residual_flexibility.resize(c * m * c * m);
  for (std::size_t i = 0; i < c * m; ++i)
    for (std::size_t j = 0; j <= i; ++j)
      surface.residual_flexibility[i * c * m + j] = surface.residual_flexibility[j * c * m + i] =
          1e-9 * normal(random);

  fill(kernel.loads.body_force, 3 * n);
  fill(kernel.loads.rotation, 3 * n);
  fill(kernel.loads.body_force_residual, c * m * 3);

  View view;
  fill(view.node, 3 * 3);
  view.element = {0, 1, 2, 2, 1, 0};
  const auto fill_single = [&](std::vector<float>& values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) values.push_back(static_cast<float>(normal(random)));
  };
  fill_single(view.shape, 9 * n);
  fill_single(view.residual_flexibility, 9 * c * m);
  fill_single(view.body_force_residual, 9 * 3);
  fill_single(view.load_residual, 9 * 3 * 2);
  fill_single(view.motion_residual, 9 * 3);
  SensitivityOf<float>& stress = view.stress.emplace();
  fill_single(stress.shape, 18 * n);
  fill_single(stress.residual_flexibility, 18 * c * m);
  fill_single(stress.body_force_residual, 18 * 3);
  fill_single(stress.load_residual, 18 * 3 * 2);
  fill_single(stress.motion_residual, 18 * 3);
  kernel.view = view;

  for (const auto& [name, unit] : {std::pair{"upper face", "Pa"}, std::pair{"point 1", "N"}}) {
    Load& load = kernel.applied.emplace_back();
    load.name = name;
    load.unit = unit;
    load.inward = load.unit == "Pa";
    fill(load.participation, 3 * n);
    fill(load.total, 9);
    fill(load.moment, 9);
    fill(load.residual, c * m * 3);
  }
  Motion& motion = kernel.motions.emplace_back();
  motion.name = "f\u00fc\u00dfe";
  fill(motion.participation, 3 * n);
  fill(motion.residual, c * m * 3);
  fill(motion.momentum, 9);
  for (const char* name : {"upper face", "rotations"}) {
    Receiver& receiver = kernel.receivers.emplace_back();
    receiver.name = name;
    receiver.point = {normal(random), normal(random), normal(random)};
    fill(receiver.shape, 3 * n);
    fill(receiver.residual_flexibility, 3 * c * m);
    fill(receiver.body_force_residual, 9);
    fill(receiver.load_residual, 3 * 3 * 2);
    fill(receiver.motion_residual, 9);
  }
  const auto fill_sensitivity = [&](Sensitivity& seen, std::size_t rows) {
    fill(seen.shape, rows * n);
    fill(seen.residual_flexibility, rows * c * m);
    fill(seen.body_force_residual, rows * 3);
    fill(seen.load_residual, rows * 3 * 2);
    fill(seen.motion_residual, rows * 3);
  };
  for (const char* name : {"upper face", "strained"}) {
    Gauge& gauge = kernel.gauges.emplace_back();
    gauge.name = name;
    gauge.point = {normal(random), normal(random), normal(random)};
    fill_sensitivity(gauge.stress, 6);
    if (kernel.gauges.size() == 2) fill_sensitivity(gauge.strain.emplace(), 1);
  }
  return kernel;
}

/// The same kernel without loads, moving supports, receivers and gauges.
inline Kernel plain_kernel(int components = 3, std::size_t n = 5, std::size_t m = 4) {
  Kernel kernel = sample_kernel(components, n, m);
  kernel.applied.clear();
  kernel.motions.clear();
  kernel.receivers.clear();
  kernel.gauges.clear();
  kernel.view->load_residual.clear();
  kernel.view->motion_residual.clear();
  kernel.view->stress->load_residual.clear();
  kernel.view->stress->motion_residual.clear();
  return kernel;
}

}  // namespace ricochet::kernels::test
