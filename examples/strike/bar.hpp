// SPDX-License-Identifier: BSD-2-Clause
// Kernels from formulas, without a mesh.
#pragma once

#include "ricochet/ricochet.hpp"

namespace strike {

struct Bar {
  double length = 0.3, height = 0.006, width = 0.03;  ///< [m]
  double young = 70e9, density = 2700;                ///< [Pa], [kg/m³]: aluminium
  double loss_factor = 2e-3;
};

/// A free Euler–Bernoulli bar along x, with its centre at the origin, that moves along z. It has two rigid
/// modes and `bending` elastic modes. The candidates lie on the centre line of its upper face, from end to
/// end.
ricochet::SharedKernel bar_kernel(const Bar& bar, int bending = 40, int candidates = 31);

/// A rigid mass that moves along the unit vector `out`, with an elastic head that faces in the opposite
/// direction.
/// @param mass  [kg]   @param stiffness  stiffness of the head [N/m]
ricochet::SharedKernel mallet_kernel(double mass, double stiffness, const ricochet::Vector3& out);

}  // namespace strike
