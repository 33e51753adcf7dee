// SPDX-License-Identifier: BSD-2-Clause
// The energy ledger that every step updates.
#pragma once

namespace ricochet {

/// Running energy ledger [J]: kinetic + strain + residual − loads + damping + contact + friction keeps its
/// initial value. Each term has its own formula.
struct Energy {
  double kinetic = 0;   ///< ½ |q̇|²; with moving supports ½ |q̇ + Γ dū/dt|²
  double strain = 0;    ///< ½ Σ ω² q²
  double residual = 0;  ///< ½ pᵀ R p, with p the forces λ and τ at the end of the step, and the energy of
                        ///< springs (contact/complementarity/patch_spring.hpp)
  double loads = 0;  ///< work so far of gravity, fᵀ (q − q0), of loads and of supports, including ∫ λᵀ ds,
                     ///< and of moving obstacles, and the energy of bodies that were added
  double added = 0;    ///< the last part of `loads`: kinetic, strain and residual energy that bodies brought
                       ///< when they were added, less what removed ones took away
  double damping = 0;  ///< ∫ 2 δ q̇², so far
  double contact = 0;  ///< removed by contact so far; compliant: λ̄ᵀ(B(q⁺ − q) + s⁺ − s) minus the growth of
                       ///< `residual`; impulse: Pᵀ (B q̇ + ṡ) − ½ |BᵀP|²; with friction: energy_ledger.hpp
  double friction = 0;  ///< heat of friction so far, Σ τ̄ᵀ d with the slip d of a step
  double total() const { return kinetic + strain + residual - loads; }
  double ledger() const { return total() + damping + contact + friction; }
};

}  // namespace ricochet
