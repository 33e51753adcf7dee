// SPDX-License-Identifier: BSD-2-Clause
// Static lifts of moving supports.
#pragma once

#include "src/modes/modes.hpp"

namespace ricochet::reduction {

/// The static lift of S moving supports, three columns each, as in elasticity::Imposed.
struct Lift {
  /// (local rows, 3S) Ψ: K Ψ = 0 on free rows, the displacement of the support on fixed rows
  Eigen::MatrixXd shape;
  Eigen::MatrixXd inertia;  ///< (local rows, 3S) M Ψ on free rows [kg]
};

/// Computes the static lift. Where supports leave rigid motion free, the lift with Φ_rᵀ M Ψ = 0 is chosen.
/// Conjugate gradients for K, preconditioned by (K − σM)⁻¹, remove the effect of the shift. Any σ < 0 is
/// possible; a small one needs few steps.
///
/// @return the same in every team. Collective on all ranks of `teams`; throws SolverError if the iteration
/// does not converge.
Lift static_lift(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
                 modes::Factorisation& factor, double sigma);

}  // namespace ricochet::reduction
