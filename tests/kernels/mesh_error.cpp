// SPDX-License-Identifier: BSD-2-Clause
// Kernels without their errors by the mesh, compared with values by hand.
#include "kernels/mesh_error.hpp"

#include <gtest/gtest.h>

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
  out.modes.mesh_error = {0, 0.19, 0.9};
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

TEST(MeshErrorOfKernels, lowers_frequencies_and_adds_flexibility) {
  const Kernel slower = kernels::without_frequency_error(kernel());
  EXPECT_DOUBLE_EQ(slower.modes.angular_frequency[0], 0);
  EXPECT_DOUBLE_EQ(slower.modes.angular_frequency[1], 2 * 0.9);             // √(1 − 0.19)
  EXPECT_DOUBLE_EQ(slower.modes.angular_frequency[2], 4 * std::sqrt(0.5));  // at most half of ω²
  // B²/ω² remains.
  EXPECT_DOUBLE_EQ(slower.surface.shape[4], 0.9);
  EXPECT_DOUBLE_EQ(slower.surface.shape[5], 2 * std::sqrt(0.5));
  const Kernel softer = kernels::without_flexibility_error(kernel());
  const std::vector<double> expected{4,    -0.5, -0.5,  -0.5,  // −0.25 √(4 · 1)
                                     -0.5, 1,    -0.25, -0.25, -0.5, -0.25, 1, 0, -0.5, -0.25, 0, 1};
  EXPECT_EQ(softer.surface.residual_flexibility, expected);
}

TEST(MeshErrorOfKernels, changes_traces_in_turn) {
  const Kernel changed = kernels::with_trace_error(kernel());
  EXPECT_DOUBLE_EQ(changed.surface.shape[0], 1);  // rigid
  EXPECT_DOUBLE_EQ(changed.surface.shape[1], 1 - 0.6 * std::sqrt(0.095));
  EXPECT_DOUBLE_EQ(changed.surface.shape[5], 2 * 1.3);  // at most 30 %
  Kernel fine = kernel();
  fine.modes.mesh_error = {0, 2e-3, 2e-3};
  EXPECT_DOUBLE_EQ(kernels::with_trace_error(fine).surface.shape[1], 1 - 3e-3);  // three times the error of ω
  fine.order = 3;
  EXPECT_DOUBLE_EQ(kernels::with_trace_error(fine).surface.shape[1], 1 - 1e-2);
}

}  // namespace mesh_error_test
}  // namespace ricochet
