// SPDX-License-Identifier: BSD-2-Clause
// A basis fitted to what contact can excite: load-dependent Ritz vectors.
#pragma once

#include "src/modes/modes.hpp"

namespace ricochet::modes {

struct ContactRequest {
  Hertz band{};                         ///< in which the flexibility matters
  double flexibility_error = 1e-3;      ///< stop when its estimate is below this, or
  std::optional<std::int64_t> count{};  ///< with so many vectors, rigid modes included, whatever the error
  bool residual_flexibility = true;  ///< what is left out statically will be added by the user of the basis
};

/// The first shift of contact_basis [rad²/s²]: K − σM is definite, rigid modes are harmless, and to the body
/// it is zero.
double shift_near_zero(Hertz band);

/// Ritz vectors of K φ = ω² M φ from the block rational Krylov space of (K − σM)⁻¹ M started by the loads'
/// responses (K − σM)⁻¹ L: four blocks about σ ≈ 0, further ones about σ = −ω_band². Rigid modes come first,
/// exact.
///
/// @param loads  L (local rows, b) [N], held components 0, the same in every team
/// @param seen  the first columns of L: the contact surface, whose flexibility over the band has to be right.
///     It is compared from one block to the next (kernels::flexibility_error). A change is about the error
///     before it; the estimate of the error after it is the change times its ratio to the change before.
/// @return vectors shared out among the teams; the certificate holds the estimate. Collective on all ranks.
/// Source: Wilson, Yuan & Dickens 1982 (load-dependent vectors); Gallivan, Grimme & Van Dooren 1996 (rational
/// Krylov spaces match moments at their shifts).
ModeSet contact_basis(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
                      Factorisation& factor, const Eigen::MatrixXd& loads, Eigen::Index seen,
                      const ContactRequest& request, const Progress& progress = {});

/// Frequency above which modes contribute less than `error` to the flexibility over the band, if they are
/// left to the residual flexibility. @param basis  of contact_basis for that band
Hertz needed_up_to(const parallel::Teams& teams, const mesh::Mesh& mesh, const ModeSet& basis,
                   const Eigen::MatrixXd& loads, Eigen::Index seen, Hertz band, double error);

}  // namespace ricochet::modes
