// SPDX-License-Identifier: BSD-2-Clause
// Exact motion of one mode over one step under a constant force.
//
//   q̈ + 2 δ q̇ + ω² q = f,   f constant over the step Δ
//   q⁺ = (1 − ω² c) q + S q̇ + c f      c = ∫₀^Δ S = (1 − C − δ S)/ω²
//   q̇⁺ = −ω² S q + S' q̇ + S f          S' = C − δ S
//   S = e^{−δΔ} sin(ω_dΔ)/ω_d,   C = e^{−δΔ} cos(ω_dΔ),   ω_d² = ω² − δ²
//
// The implementation covers ζ = δ/ω below, at and above 1 as well as ω = 0, without cancellation if ωΔ or δΔ
// is small.
#pragma once

namespace ricochet::contact {

/// The response to a unit impulse, its rate S', and its integrals c = ∫₀ᵗ S, r = ∫₀ᵗ c, w = ∫₀ᵗ r.
struct ModeResponse {
  double rate, S, c, r, w;
};

/// @param omega  ω ≥ 0 [rad/s]   @param decay  δ ≥ 0 [1/s]   @param time  t ≥ 0 [s]
ModeResponse mode_response(double omega, double decay, double time) noexcept;

/// The response at the end of a step, with integrals of squares that give the work of damping.
struct ModeStep : ModeResponse {
  /// Energy that damping dissipates over the step, exactly:
  /// ∫ 2δ q̇² dt = 2δ [ss g² + 2 sr g q̇ + rr q̇²],  g = f − ω² q,  ss = ∫S², sr = ∫S S' = S(Δ)²/2, rr = ∫S'²,
  /// because q̇(t) = g S(t) + q̇ S'(t). Each integral has its own closed form; none comes from the energy
  /// balance.
  double ss, sr, rr;
  /// cc = ∫c², for a force that changes linearly:
  /// ∫ q dt = Δ q + c q̇ + r g + w k   and   q̇(t) = g S(t) + q̇ S'(t) + k c(t),
  /// ∫ q̇² dt = ss g² + 2 sr g q̇ + rr q̇² + c² g k + 2 (S c − ss) q̇ k + cc k².
  double cc;
};

/// @param step  Δ > 0 [s]
ModeStep mode_step(double omega, double decay, double step) noexcept;

}  // namespace ricochet::contact
