// SPDX-License-Identifier: BSD-2-Clause
// The number of modes that a body has, estimated before they are computed.
#pragma once

#include <functional>
#include <span>

namespace ricochet::kernels {

/// Number of eigenvalues below λ = ω² [1/s²].
using ExpectedCount = std::function<double(double)>;

/// Estimates the number of modes of a box with the mass [kg], inertia ((3,3), about the centre, [kg m²]) and
/// wave speed √(E/ρ) [m/s] of a body. By Weyl's law, the box has in-plane and bending waves over its two
/// longest sides, and waves through all three. A rod has longitudinal waves.
ExpectedCount expected_count(double mass, std::span<const double> inertia, double wave_speed);

}  // namespace ricochet::kernels
