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
  /// Energy a damper takes over the step, exactly:
  /// ∫ 2δ q̇² dt = 2δ [ss g² + 2 sr g q̇ + rr q̇²],  g = f − ω² q,  ss = ∫S², sr = ∫S S' = S(Δ)²/2, rr = ∫S'²,
  /// because q̇(t) = g S(t) + q̇ S'(t). Each integral from its own closed form, not from the energy balance.
  double ss, sr, rr;
};

/// @param omega  ω ≥ 0 [rad/s]   @param decay  δ ≥ 0 [1/s]   @param step  Δ > 0 [s]
ModeStep mode_step(double omega, double decay, double step) noexcept;

}  // namespace ricochet::contact
