// SPDX-License-Identifier: BSD-2-Clause
// Static contact: the bodies at rest under constant loads.
//
//   u = û + B_r ρ − S₀ λ      û = Σ B_n f_n/ω_n² + s,   S₀ = Σ B_n B_nᵀ/ω_n² + R   over elastic modes
//   0 ≤ λ  ⟂  g − u ≥ 0       B_rᵀ λ = f_r                over rigid modes (ω = 0), of coordinates ρ
//
// That is the functional of the source paper's section 3.2, with the equilibrium of bodies that are free to
// move:
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
    uzawa,  ///< the source paper's iteration on the pressures, for reference
  };
  Solver solver = Solver::exact;
  double uzawa_tolerance = 1e-9;              ///< of the gap at the points that press, relative to û − g
  std::int64_t uzawa_iterations = 1'000'000;  ///< at most, in all
};

struct Equilibrium {
  Vector q;             ///< (N) modal displacement [kg^1/2 m]; rigid motion that no contact feels is 0
  Vector force;         ///< (m) λ [N]
  Vector displacement;  ///< (m) u [m]
  Energy energy;   ///< strain, residual, and the work of loads fᵀ q as if they had always been constant
  int active = 0;  ///< points with λ > 0
  double imbalance = 0;         ///< max |f_r − B_rᵀ λ|, relative to the largest sum of magnitudes in it
  std::int64_t iterations = 0;  ///< complementarity problems, or Uzawa's iterations
};

/// The method of multipliers (Hestenes 1969, Powell 1969): springs D hold the rigid coordinates, each problem
///   minimise ½ λᵀ (S₀ + B_r D B_rᵀ) λ − λᵀ (û − g + B_r (ρ + D f_r))   over λ ≥ 0
/// is solved, and ρ ← ρ + D (f_r − B_rᵀ λ) until the springs hold nothing.
/// Throws InputError when no contact forces can hold a body's weight, or, without R, keep the bodies apart;
/// SolverError when Uzawa's iteration does not come to an end or the model is not finite.
Equilibrium find_equilibrium(const Model& model, const EquilibriumOptions& options = {});

}  // namespace ricochet::contact
