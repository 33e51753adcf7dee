// SPDX-License-Identifier: BSD-2-Clause
// Static lifts of supports that move.
#pragma once

#include "src/modes/modes.hpp"

namespace ricochet::modes {

/// Three columns for each of S moved supports, as in elasticity::Imposed.
struct Lift {
  Eigen::MatrixXd shape;  ///< (local rows, 3S) Ψ: K Ψ = 0 on free rows, the support's displacement on held
  Eigen::MatrixXd inertia;  ///< (local rows, 3S) M Ψ on free rows [kg]
};

/// Of the lifts that differ by rigid motions left free, the one with Φ_rᵀ M Ψ = 0. The shift σ < 0 may be any
/// at which the factors are wanted anyway: conjugate gradients for K with (K − σM)⁻¹ as preconditioner undo
/// it, in few steps if it is small.
///
/// @return the same in every team. Collective on all ranks of `teams`; throws SolverError when it does not
/// converge.
Lift static_lift(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
                 Factorisation& factor, double sigma);

}  // namespace ricochet::modes
