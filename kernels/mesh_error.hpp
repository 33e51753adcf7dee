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

/// The kernel with frequencies without their estimated errors, at most half of ω². Traces fall with them, so
/// that the static flexibility B Bᵀ/ω² remains, whose error is that of the flexibility. The kernel must have
/// errors.
Kernel without_frequency_error(Kernel kernel);

/// The kernel with a flexibility without its estimated errors, which R takes. The kernel must have errors.
Kernel without_flexibility_error(Kernel kernel);

/// The kernel with traces that are changed by their estimated errors, with the relative error ε of ω: 3 ε on
/// elements of order 2, 10 ε on those of higher order, at most 0.6 √ε and 30 %. The traces of modes change by
/// so much more than their frequencies; those of every other mode grow, because their signs are unrelated.
/// The static flexibility remains. The kernel must have errors.
Kernel with_trace_error(Kernel kernel);

}  // namespace ricochet::kernels
