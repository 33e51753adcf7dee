// SPDX-License-Identifier: BSD-2-Clause
// Kernels that differ from another one by its estimated errors by the mesh.
#pragma once

#include <utility>
#include <vector>

#include "ricochet/kernel.hpp"

namespace ricochet::kernels {

/// Whether the errors are estimated.
bool has_mesh_error(const Kernel& kernel);

/// Candidates with a common element. @return (P) pairs i < j, ascending
std::vector<std::pair<std::size_t, std::size_t>> neighbours(const Surface& surface);

/// The kernel with the modes of an infinitely fine mesh, by the estimated error E of the stiffness of its
/// own: those of the flexibility Ω⁻¹ (1 + E) Ω⁻¹, which is positive however large E is, and for small errors
/// the inverse of the stiffness Ω (1 − E) Ω. They have other frequencies, and traces that combine those of
/// the modes; on rods, whose nodes have their exact static displacements, traces fall with frequencies. The
/// kernel must have errors.
Kernel without_stiffness_error(Kernel kernel);

/// The kernel with a flexibility without its estimated errors, which R takes. The kernel must have errors.
Kernel without_flexibility_error(Kernel kernel);

}  // namespace ricochet::kernels
