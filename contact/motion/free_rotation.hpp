// SPDX-License-Identifier: BSD-2-Clause
// The rotation of a rigid body without torque.
//
// The implicit midpoint rule of Lie–Poisson with the Cayley map, for the angular momentum L in world axes and
// π = AᵀL in body axes:
//
//   π⁺ = π + h π_m × J⁻¹π_m,   π_m = (π + π⁺)/2,   A⁺ = A cay(h J⁻¹π_m)
//
// Since cay(h Ω_m)ᵀ π = π⁺, L does not change. The rule conserves ½ πᵀJ⁻¹π, a quadratic invariant. Its error
// is of second order. Simo & Wong 1991; Lewis & Simo 1994.
#pragma once

#include <Eigen/Geometry>

namespace ricochet::contact {

/// About the centre of mass, in body axes.
struct Inertia {
  Eigen::Matrix3d tensor;   ///< J [kg m²]
  Eigen::Matrix3d inverse;  ///< J⁻¹
  double largest_inverse;   ///< largest eigenvalue of J⁻¹: |Ω| is at most this times |L|

  /// Of a body that nothing turns.
  static Inertia infinite() { return {Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero(), 0}; }

  /// @param tensor  positive definite
  static Inertia of(const Eigen::Matrix3d& tensor);
};

/// Turns the attitude A, from body axes to world axes, over `time` [s], which may be negative. Returns ∫Ω dt
/// in body axes [rad].
/// @param momentum  L [kg m²/s], world axes
/// @param angle  largest angle of a step [rad], at most 1/4
Eigen::Vector3d turn_freely(Eigen::Quaterniond& attitude, const Eigen::Vector3d& momentum,
                            const Inertia& inertia, double time, double angle) noexcept;

/// The same with an error of fourth order, by five such steps in place of one, the third of which goes back
/// (Suzuki 1990).
Eigen::Vector3d fly_freely(Eigen::Quaterniond& attitude, const Eigen::Vector3d& momentum,
                           const Inertia& inertia, double time, double angle) noexcept;

}  // namespace ricochet::contact
