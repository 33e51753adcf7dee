// SPDX-License-Identifier: BSD-2-Clause
// Exact motion of one mode over one step under a constant force.
//
//   q̈ + 2 δ q̇ + ω² q = f,   f constant over the step Δ
//   q⁺ = a q + b q̇ + c f         a = C + δ S      b = S                c = (1 − a)/ω²  (ω = 0: ∫₀^Δ S)
//   q̇⁺ = d q + e q̇ + h f         d = −ω² S        e = C − δ S          h = S
//   S = e^{−δΔ} sin(ω_dΔ)/ω_d,   C = e^{−δΔ} cos(ω_dΔ),   ω_d² = ω² − δ²
//
// for ζ = δ/ω below, at and above 1 and for ω = 0, without cancellation when ωΔ or δΔ is small.
#pragma once

namespace ricochet::contact {

struct ModeStep {
  double a, b, c, d, e, h;
  /// Exact energy that damping takes over the step:
  /// ∫ 2δ q̇² dt = 2δ [ss g² + 2 sr g q̇ + rr q̇²],  g = f − ω² q,  ss = ∫S², sr = ∫S S' = S(Δ)²/2, rr = ∫S'²,
  /// because q̇(t) = g S(t) + q̇ S'(t). Each integral has its own closed form; none comes from the energy
  /// balance.
  double ss, sr, rr;
  /// For a force that changes linearly: r = ∫c, w = ∫r, cc = ∫c². They give
  /// ∫ q dt = Δ q + c q̇ + r g + w k   and   q̇(t) = g S(t) + q̇ S'(t) + k c(t),
  /// ∫ q̇² dt = ss g² + 2 sr g q̇ + rr q̇² + c² g k + 2 (S c − ss) q̇ k + cc k².
  double r, w, cc;
};

/// @param omega  ω ≥ 0 [rad/s]   @param decay  δ ≥ 0 [1/s]   @param step  Δ > 0 [s]
ModeStep mode_step(double omega, double decay, double step) noexcept;

/// The response to a unit impulse, and its integrals c = ∫₀ᵗ S, r = ∫₀ᵗ c, w = ∫₀ᵗ r, without the squares.
struct ModeResponse {
  double rate, S, c, r, w;
};

/// @param omega  ω ≥ 0 [rad/s]   @param decay  δ ≥ 0 [1/s]   @param time  t ≥ 0 [s]
ModeResponse mode_response(double omega, double decay, double time) noexcept;

}  // namespace ricochet::contact
