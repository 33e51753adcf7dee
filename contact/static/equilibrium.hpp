// SPDX-License-Identifier: BSD-2-Clause
// Static contact: the bodies at rest under their loads.
//
//   u = û + B_r ρ − S₀ λ      û = Σ B_n f_n/ω_n² + s,   S₀ = Σ B_n B_nᵀ/ω_n² + R   over elastic modes
//   0 ≤ λ  ⟂  g − u ≥ 0       B_rᵀ λ = f_r                over rigid modes (ω = 0), of coordinates ρ
//
// These are the conditions for the minimum of the functional in section 3.2 of the source paper, together
// with the equilibrium of bodies that can move rigidly:
//
//   minimise ½ λᵀ S₀ λ − λᵀ (û − g)   over λ ≥ 0 with B_rᵀ λ = f_r;   ρ are the multipliers of the latter
//
// Springs s(λ) of the points (patch_spring.hpp) are added to S₀ λ, and ∫ s dλ to the functional. Uzawa's
// iteration then solves the linear problems of spring_newton.hpp.
//
// With friction, rows and p include the tangential ones, and the loads follow a path in increments: first
// gravity and constant loads grow together (the preload), then the histories of loads, supports and
// half-spaces from knot to knot (load_path.hpp). In each increment, from w to w⁺ and by the same S₀,
//
//   d = w⁺ − w − belt         |τ| ≤ μ_s λ,   d ≠ 0 ⇒ τ = μ_s λ d/|d|        B_rᵀ p = f_r
//
// Speeds are 0 at rest, so the coefficient is μ_s. Inertia plays no part.
#pragma once

#include <cstdint>
#include <functional>

#include "contact/complementarity/friction_solver.hpp"
#include "contact/model/model.hpp"
#include "ricochet/energy.hpp"

namespace ricochet::contact {

struct EquilibriumOptions {
  enum class Solver {
    exact,  ///< complementarity, to round-off
    uzawa,  ///< the iteration on the pressures in the source paper, for reference
  };
  Solver solver = Solver::exact;
  double uzawa_tolerance = 1e-9;              ///< for the gaps of pressed points, relative to û − g
  std::int64_t uzawa_iterations = 1'000'000;  ///< upper limit over all problems
  /// With friction: parts of each stage of the loads. Slip depends on the path, so the result errs by what
  /// happens within one part: points that close, and normal forces that change as points slip.
  int increments = 20;
};

struct Equilibrium {
  double time = 0;      ///< of the knot of the histories [s]
  Vector q;             ///< (N) modal displacement [kg^1/2 m]; rigid motion that no contact feels is 0
  Vector force;         ///< (n) λ and τ [N]
  Vector displacement;  ///< (n) u [m]
  std::vector<ContactState> states{};  ///< (f) of the points with friction
  /// Strain, residual, and the work fᵀ q of loads as if they had always been constant. With friction, from
  /// the unloaded bodies on, by sums over increments with the mean x̄ of x and x⁺:
  ///   loads     Σ f̄ᵀ (q⁺ − q) + p̄ᵀ (s⁺ − s) − τ̄ᵀ belt
  ///   friction  Σ τ⁺ᵀ d ≥ 0, the heat
  ///   contact   Σ λ̄ᵀ (u⁺ − u) − ½ (τ⁺ − τ)ᵀ d: what increments err, which vanishes as they shrink; of
  ///             springs also Σ λ̄ (s⁺ − s) − (e⁺ − e)
  /// so that the ledger is 0.
  Energy energy;
  int active = 0;        ///< points with λ > 0
  double imbalance = 0;  ///< max |f_r − B_rᵀ p|, relative to the largest sum of the magnitudes of its terms
  /// With friction: increments so far whose forces are known not to be the only ones that meet Coulomb's law,
  /// and their number.
  std::int64_t ambiguous = 0, increments = 0;
  std::int64_t iterations = 0;  ///< number of complementarity problems, or of Uzawa's iterations
};

/// The method of multipliers (Hestenes 1969, Powell 1969): springs D hold the rigid coordinates, each problem
///   minimise ½ λᵀ (S₀ + B_r D B_rᵀ) λ − λᵀ (û − g + B_r (ρ + D f_r))   over λ ≥ 0
/// is solved, followed by ρ ← ρ + D (f_r − B_rᵀ λ), until the springs carry no force. With friction, each
/// problem is one of Coulomb's law with S₀ + B_r D B_rᵀ.
/// Without friction, the path does not matter, and loads are those after the last knot of the histories.
/// @param at_knot  receives the equilibrium that is returned; with friction, before it that of each knot at
/// which a load has changed, in ascending order
/// Throws InputError if no contact forces can hold the loads of a body or, without R, keep the bodies apart,
/// or if Uzawa's iteration meets friction. Throws SolverError if a solver does not converge or the model is
/// not finite.
Equilibrium find_equilibrium(const Model& model, const EquilibriumOptions& options = {},
                             const std::function<void(const Equilibrium&)>& at_knot = {});

}  // namespace ricochet::contact
