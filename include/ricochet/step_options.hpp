// SPDX-License-Identifier: BSD-2-Clause
// How time is stepped, shared by scenes, the library and both embedding interfaces: the schemes with their
// options, the status of a step, and the energy ledger that every step closes.
#pragma once

#include <limits>

namespace ricochet {

enum class Scheme {
  compliant,  ///< λ constant over the step, Signorini at its end with the residual flexibility
  impulse,    ///< the source paper's algorithm (30): impulses at the instants t_k on the points found beyond
              ///< their gap
  at_rest,    ///< "static": equilibrium, no steps
};
enum class Admittance {
  jump,        ///< A = Ṅ(0⁺) = B Bᵀ, v̂ the velocity at t_k: the printed reading
  difference,  ///< A = N(Δ)/Δ, v̂ = (û(t_{k+1}) − u(t_k))/Δ
};

enum class Instant {
  step,   ///< at t_k
  exact,  ///< a point that closes within the step is met there and then, and again at t_k if it is beyond its
          ///< gap
};

enum class Precision { float64, float32 };

struct StepOptions {
  Scheme scheme = Scheme::compliant;
  Admittance admittance = Admittance::jump;
  Instant instant = Instant::step;  ///< of the impulse scheme
  double restitution = 0;           ///< e of the impulse scheme, in [0, 1]
  double step = 0;                  ///< Δ [s]
  /// Bound on the work of a step: changes of a point between touching and open that its solve may make.
  int max_pivots = std::numeric_limits<int>::max();
  /// Steps that the compliant scheme looks ahead by one matrix product; 1: none, 0: as suits the number of
  /// points. The result is the same to round-off.
  int block = 0;
  /// Of the products of a block. State, contact and rigid motion stay in double precision.
  Precision precision = Precision::float64;
  /// Keep q, q̇ and the energy ledger after each step. Without it blocks keep them for their ends only, or
  /// until catch_up(), and are faster: only forces are known after each step. Loads that vary: always kept.
  bool every_state = true;
};

enum class StepStatus {
  ok,
  no_solution,
  not_finite,
  table_ended,  ///< tables only: the step is beyond its table
};

/// Running energy ledger [J]; kinetic + strain + residual − loads + damping + contact stays what it was at t
/// = 0. Each term from its own formula.
struct Energy {
  double kinetic = 0;   ///< ½ |q̇|², of supports that move ½ |q̇ + Γ dū/dt|²
  double strain = 0;    ///< ½ Σ ω² q²
  double residual = 0;  ///< ½ λᵀ R λ
  double loads = 0;     ///< work so far of gravity, fᵀ (q − q0), loads and supports, with ∫ λᵀ ds
  double damping = 0;   ///< ∫ 2 δ q̇², so far
  double contact = 0;  ///< taken out by contact so far: compliant λᵀ(B(q⁺ − q) + s⁺ − s) less the growth of
                       ///< ½ λᵀRλ; impulse Pᵀ (B q̇ + ṡ) − ½ |BᵀP|²
  double total() const { return kinetic + strain + residual - loads; }
  double ledger() const { return total() + damping + contact; }
};

}  // namespace ricochet
