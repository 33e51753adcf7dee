// SPDX-License-Identifier: BSD-2-Clause
// Kernels without their errors by the mesh, compared with values by hand.
#include "kernels/mesh_error.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

namespace ricochet {
namespace mesh_error_test {

using kernels::Kernel;

/// Three candidates in two triangles of four, of which the last two are no neighbours of each other, and a
/// rigid and two elastic modes.
Kernel kernel() {
  Kernel out;
  out.order = 2;
  out.modes.angular_frequency = {0, 2, 4};
  out.modes.stiffness_error = {0, 0, 0, 0, 0.21, 0, 0, 0, 0.44};
  out.surface.components = 1;
  out.surface.direction = Vector3{0, 0, 1};
  out.surface.area = {1, 1, 1, 1};
  out.surface.normal = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
  out.surface.element = {0, 1, 2, 0, 1, 3};
  out.surface.shape = {1, 1, 0, 1, 1, 2, 1, 1, 1, 1, 1, 1};
  out.surface.residual_flexibility.assign(16, 0.0);
  out.surface.mesh_error = {4, 1, 1, 1};
  out.surface.mesh_error_coupling = 0.25;
  return out;
}

TEST(MeshErrorOfKernels, adds_flexibility) {
  const Kernel softer = kernels::without_flexibility_error(kernel());
  const std::vector<double> expected{4,    -0.5, -0.5,  -0.5,  // −0.25 √(4 · 1)
                                     -0.5, 1,    -0.25, -0.25, -0.5, -0.25, 1, 0, -0.5, -0.25, 0, 1};
  EXPECT_EQ(softer.surface.residual_flexibility, expected);
}

// Without coupling, ω² falls to ω²/(1 + E), and traces remain.
TEST(MeshErrorOfKernels, lowers_frequencies) {
  const Kernel had = kernel(), slower = kernels::without_stiffness_error(had);
  EXPECT_EQ(slower.modes.angular_frequency[0], 0);
  EXPECT_NEAR(slower.modes.angular_frequency[1], 2 / 1.1, 1e-7);
  EXPECT_NEAR(slower.modes.angular_frequency[2], 4 / 1.2, 1e-7);
  for (std::size_t k = 0; k < 12; ++k)
    EXPECT_NEAR(std::abs(slower.surface.shape[k]), std::abs(had.surface.shape[k]), 1e-12);
}

// Two elastic modes that the error couples: their motion has the flexibility Ω⁻¹ (1 + E) Ω⁻¹, whatever the
// modes, and their traces the same squares.
TEST(MeshErrorOfKernels, combines_coupled_modes) {
  Kernel had = kernel();
  had.modes.stiffness_error = {0, 0, 0, 0, 0.25, 0.125, 0, 0.125, 0.5};
  had.receivers = {{.name = "tip", .point = {}, .shape = {1, 5, 7, 1, 0, 2, 1, 3, 0}}};
  const Kernel made = kernels::without_stiffness_error(had);
  const Eigen::Matrix2d flexible{{1.25 / 4, 0.125 / 8}, {0.125 / 8, 1.5 / 16}};
  const auto rows = [](const Kernel& of) {
    std::vector<Eigen::Vector2d> out;
    for (const std::vector<double>& shape : {of.surface.shape, of.receivers[0].shape})
      for (std::size_t k = 0; k < shape.size(); k += 3) out.emplace_back(shape[k + 1], shape[k + 2]);
    return out;
  };
  const Eigen::Vector2d inverse =
      Eigen::Vector2d(made.modes.angular_frequency[1], made.modes.angular_frequency[2])
          .cwiseAbs2()
          .cwiseInverse();
  const auto was = rows(had), is = rows(made);
  for (std::size_t i = 0; i < was.size(); ++i)
    for (std::size_t j = 0; j < was.size(); ++j) {
      EXPECT_NEAR(is[i].dot(is[j]), was[i].dot(was[j]), 1e-12);
      EXPECT_NEAR(is[i].dot(inverse.asDiagonal() * is[j]), was[i].dot(flexible * was[j]), 1e-12);
    }
  EXPECT_EQ(made.surface.shape[0], had.surface.shape[0]);  // rigid
}

}  // namespace mesh_error_test
}  // namespace ricochet
