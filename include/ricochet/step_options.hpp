// SPDX-License-Identifier: BSD-2-Clause
// The schemes of time stepping with their options, the status of a step, and the energy ledger that every
// step updates. Shared by scenes, the library and both embedding interfaces.
#pragma once

#include <limits>

namespace ricochet {

enum class Scheme {
  compliant,  ///< λ constant over the step; Signorini's conditions at its end, with the residual flexibility
  impulse,    ///< algorithm (30) of the source paper: impulses at the instants t_k on the points that are
              ///< found beyond their gap
  at_rest,    ///< "static": equilibrium, no steps
};
enum class Admittance {
  jump,        ///< A = Ṅ(0⁺) = B Bᵀ, v̂ the velocity at t_k, as printed in the paper
  difference,  ///< A = N(Δ)/Δ, v̂ = (û(t_{k+1}) − u(t_k))/Δ
};

enum class Instant {
  step,   ///< at t_k
  exact,  ///< event location: impulse at the instant at which a point closes within the step, and again at
          ///< t_k if the point is beyond its gap
};

/// Coulomb friction of a contact pair. With the sliding speed v of a point,
/// μ(v) = μ_d + (μ_s − μ_d) exp(−(v/v_s)²), Stribeck's transition from sticking to sliding.
struct Friction {
  double static_coefficient = 0;   ///< μ_s ≥ 0, of points that stick
  double dynamic_coefficient = 0;  ///< μ_d ≥ 0, of points that slide fast
  double stribeck_velocity = 0;    ///< v_s > 0 [m/s]; unused if the coefficients are equal
  bool operator==(const Friction&) const = default;
};

enum class Precision { float64, float32 };

/// The force that drives the modes over a step of the compliant scheme.
enum class ContactStep {
  conserving,      ///< a mean of the forces at the last three instants: second order, and contact in place
                   ///< conserves energy
  backward_euler,  ///< the force at the end of the step: first order, and every change of force costs energy
};

struct StepOptions {
  Scheme scheme = Scheme::compliant;
  Admittance admittance = Admittance::jump;
  Instant instant = Instant::step;                     ///< of the impulse scheme
  double restitution = 0;                              ///< e of the impulse scheme, in [0, 1]
  ContactStep contact_step = ContactStep::conserving;  ///< of the compliant scheme
  double step = 0;                                     ///< Δ [s]
  /// Number of contact steps Δ per output sample. In free flight, the compliant scheme jumps from sample to
  /// sample; it makes contact steps only where a point could close.
  int steps_per_sample = 1;
  /// Bound on the work of a step: the number of changes of the active set in its solve. Where points have
  /// springs (contact/complementarity/patch_spring.hpp), it bounds each of at most 8 linear problems.
  int max_pivots = std::numeric_limits<int>::max();
  /// Length of a look-ahead block: the number of steps of the compliant scheme computed by one matrix
  /// product. 1 turns blocks off; 0 chooses the length from the number of points. The result is the same to
  /// round-off.
  int block = 0;
  /// Precision of the products of a block. State, contact and rigid motion stay in double precision.
  Precision precision = Precision::float64;
  /// Whether q, q̇ and the energy ledger are known after each step. Otherwise, blocks are faster, but only
  /// forces are known after each step; the rest is known at the end of a block and after catch_up(). With
  /// loads that vary, this is always on.
  bool every_state = true;
};

enum class StepStatus {
  ok,
  no_solution,
  not_finite,
  table_ended,  ///< table kernels: the step is beyond the end of the table
};

/// Running energy ledger [J]: kinetic + strain + residual − loads + damping + contact + friction keeps its
/// initial value. Each term has its own formula.
struct Energy {
  double kinetic = 0;   ///< ½ |q̇|²; with moving supports ½ |q̇ + Γ dū/dt|²
  double strain = 0;    ///< ½ Σ ω² q²
  double residual = 0;  ///< ½ pᵀ R p, with p the forces λ and τ at the end of the step, and the energy of
                        ///< springs (contact/complementarity/patch_spring.hpp)
  double loads = 0;  ///< work so far of gravity, fᵀ (q − q0), of loads and of supports, including ∫ λᵀ ds,
                     ///< and of moving obstacles
  double damping = 0;  ///< ∫ 2 δ q̇², so far
  double contact = 0;  ///< removed by contact so far; compliant: λ̄ᵀ(B(q⁺ − q) + s⁺ − s) minus the growth of
                       ///< `residual`; impulse: Pᵀ (B q̇ + ṡ) − ½ |BᵀP|²; with friction: energy_ledger.hpp
  double friction = 0;  ///< heat of friction so far, Σ τ̄ᵀ d with the slip d of a step
  double total() const { return kinetic + strain + residual - loads; }
  double ledger() const { return total() + damping + contact + friction; }
};

}  // namespace ricochet
