// SPDX-License-Identifier: BSD-2-Clause
// Static contact: the bodies at rest under constant loads.
//
//   u = û + B_r ρ − S₀ λ      û = Σ B_n f_n/ω_n² + s,   S₀ = Σ B_n B_nᵀ/ω_n² + R   over elastic modes
//   0 ≤ λ  ⟂  g − u ≥ 0       B_rᵀ λ = f_r                over rigid modes (ω = 0), of coordinates ρ
//
// These are the conditions for the minimum of the functional in section 3.2 of the source paper, together
// with the equilibrium of bodies that can move rigidly:
//
//   minimise ½ λᵀ S₀ λ − λᵀ (û − g)   over λ ≥ 0 with B_rᵀ λ = f_r;   ρ are the multipliers of the latter
#pragma once

#include <cstdint>

#include "contact/model/model.hpp"
#include "ricochet/step_options.hpp"

namespace ricochet::contact {

struct EquilibriumOptions {
  enum class Solver {
    exact,  ///< complementarity, to round-off
    uzawa,  ///< the iteration on the pressures in the source paper, for reference
  };
  Solver solver = Solver::exact;
  double uzawa_tolerance = 1e-9;              ///< for the gaps of pressed points, relative to û − g
  std::int64_t uzawa_iterations = 1'000'000;  ///< upper limit over all problems
};

struct Equilibrium {
  Vector q;             ///< (N) modal displacement [kg^1/2 m]; rigid motion that no contact feels is 0
  Vector force;         ///< (m) λ [N]
  Vector displacement;  ///< (m) u [m]
  Energy energy;   ///< strain, residual, and the work fᵀ q of loads as if they had always been constant
  int active = 0;  ///< points with λ > 0
  double imbalance = 0;  ///< max |f_r − B_rᵀ λ|, relative to the largest sum of the magnitudes of its terms
  std::int64_t iterations = 0;  ///< number of complementarity problems, or of Uzawa's iterations
};

/// The method of multipliers (Hestenes 1969, Powell 1969): springs D hold the rigid coordinates, each problem
///   minimise ½ λᵀ (S₀ + B_r D B_rᵀ) λ − λᵀ (û − g + B_r (ρ + D f_r))   over λ ≥ 0
/// is solved, followed by ρ ← ρ + D (f_r − B_rᵀ λ), until the springs carry no force.
/// Throws InputError if no contact forces can hold the weight of a body or, without R, keep the bodies apart.
/// Throws SolverError if Uzawa's iteration does not converge or the model is not finite.
Equilibrium find_equilibrium(const Model& model, const EquilibriumOptions& options = {});

}  // namespace ricochet::contact
