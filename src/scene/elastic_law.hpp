// SPDX-License-Identifier: BSD-2-Clause
// What the elastic constants of a material imply: its stiffness, whether they are admissible, and the figures
// by which bodies are judged.
#pragma once

#include <array>
#include <optional>

#include "src/scene/data/body.hpp"

namespace ricochet::scene {

/// C in the axes of the material, (6,6) [Pa]: stress xx, yy, zz, yz, xz, xy = C · strain, with the
/// engineering shear strains γ = 2 ε. Not for rods.
std::array<double, 36> stiffness_of(const Material& material);

/// Returns the smallest eigenvalue of the matrix that the constants of an anisotropic material fill, if this
/// matrix is not positive definite: of C [Pa], or of the compliance [1/Pa] if nine constants are given.
std::optional<double> refused_eigenvalue(const Material& material);

/// Smallest Young's modulus of all directions [Pa]; of an anisotropic material, over directions 3° apart.
double softest_young(const Material& material);

/// Poisson's ratio. Of an anisotropic material: of the isotropic one with the same change of volume under a
/// pressure and with the same shear compliance in the mean over all directions (Reuss 1929).
double mean_poisson(const Material& material);

/// √(E/ρ) [m/s]. Young's modulus is that along a direction, over which bounds on impacts have their meaning,
/// and in the mean over directions as for mean_poisson, which counts modes: most of them are slow waves.
struct WaveSpeeds {
  double low, high;  ///< in the softest and in the stiffest direction, 3° apart
  double mean;
};
WaveSpeeds wave_speeds(const Material& material);

/// The smallest, the largest, and the largest mean of the materials of a body; infinity, 0 and 0 if it has
/// none.
WaveSpeeds wave_speeds(const Body& body);

/// Multiplies the stiffness by a factor.
void stiffen(Material& material, double factor);

/// The factor by which the stiffness of `wanted` exceeds that of `had` in one constant. If the laws are
/// proportional, this is true of all constants.
double stiffness_ratio(const Material& had, const Material& wanted);

/// Whether both have the same law up to a few roundings, in the same axes.
bool same_law(const Material& a, const Material& b);

}  // namespace ricochet::scene
