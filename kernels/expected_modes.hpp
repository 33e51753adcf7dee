// SPDX-License-Identifier: BSD-2-Clause
// The number of modes that a body has, estimated before they are computed.
#pragma once

#include <functional>
#include <span>

namespace ricochet::kernels {

/// Number of eigenvalues below λ = ω² [1/s²].
using ExpectedCount = std::function<double(double)>;

/// The measures of a body on which the number of its modes depends.
struct Extent {
  double volume = 0;   ///< V [m³]
  double surface = 0;  ///< S [m²]; 0: a rod, which has longitudinal waves only
  double length = 0;   ///< l [m], longest side of a box with the inertia of the body
};

/// The measures of a box with this mass [kg] and inertia ((3,3), about the centre, [kg m²]), for bodies of
/// which nothing else is known; those of a rod, if it is one.
Extent box_of(double mass, std::span<const double> inertia);

/// Estimates the number of elastic modes: the largest of three laws. With h = 2V/S, k_t = ω/c_t and
/// α = c_t²/c_l²,
///
///   solid  V k_t³ (2 + α^(3/2)) / 6π²  +  S k_t² (3 − 3α + 2α²) / (16π (1 − α))
///   plate  S (k_b(h)² + ω²/c_p² + k_t²) / 8π
///   beam   l (k_b(w) + k_b(t) + ω/c + ω/c_θ) / π
///
/// k_b is the wave number of bending waves (with shear and rotary inertia), c_p the speed of stretching waves
/// in a plate, c that in a rod, and c_θ that of torsion. The beam is a box of length l with the volume and
/// the surface of the body; w and t are its other sides. A plate has as many waves of all kinds as Rayleigh
/// and Lamb's equation gives, within a tenth. Curvature and supports have no part in the estimate.
/// @param wave_speed  c = √(E/ρ) [m/s]
/// @param poisson     Poisson's ratio
/// Source: Dupuis, Mazo & Onsager 1960 (both terms of solids with free surfaces); Mindlin 1951 (k_b).
ExpectedCount expected_count(const Extent& extent, double wave_speed, double poisson);

}  // namespace ricochet::kernels
