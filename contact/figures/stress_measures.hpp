// SPDX-License-Identifier: BSD-2-Clause
// What a stress amounts to in a body.
#pragma once

namespace ricochet::contact {

/// √(½ ((σx − σy)² + (σy − σz)² + (σz − σx)²) + 3 (τ_yz² + τ_xz² + τ_xy²)) of a stress xx, yy, zz, yz, xz,
/// xy.
double von_mises(const double* stress) noexcept;

/// Mean of xx, yy, zz.
inline double mean_stress(const double* s) noexcept { return (s[0] + s[1] + s[2]) / 3; }

/// The largest and the smallest principal stress, σ₁ ≥ σ₃.
///
///   σ₁ = p + ⅔ σ_v cos θ,   σ₃ = p + ⅔ σ_v cos(θ + 2π/3),   cos 3θ = 27 det(σ − p) / (2 σ_v³)
///
/// p is the mean, σ_v the von Mises stress. Hence σ₁ ≤ p + ⅔ σ_v and ½ (σ₁ − σ₃) ≤ σ_v/√3.
/// Round-off is up to 1e-8 σ_v, where two principal stresses meet.
struct Principal {
  double first, third;
};
Principal principal(const double* stress) noexcept;

/// √(Σ σ_ij²), which bounds what a part of a stress adds: to σ_v at most √1.5 of it, to σ₁ once, and to the
/// largest shear stress ½ (σ₁ − σ₃) 1/√2 of it.
double frobenius(const double* stress) noexcept;

}  // namespace ricochet::contact
