// SPDX-License-Identifier: BSD-2-Clause
// Contact-adapted basis: load-dependent Ritz vectors.
#pragma once

#include "src/modes/modes.hpp"

namespace ricochet::modes {

struct ContactRequest {
  Hertz band{};                         ///< in which the flexibility must be accurate
  double flexibility_error = 1e-3;      ///< bound on its estimate, or
  std::optional<std::int64_t> count{};  ///< number of vectors, rigid modes included
  bool residual_flexibility = true;     ///< the caller will add the static correction
};

/// The first shift of contact_basis [rad²/s²]. K − σM is definite, so rigid modes are harmless, and σ is
/// negligible for the elastic modes.
double shift_near_zero(Hertz band);

/// Ritz vectors of K φ = ω² M φ from the block rational Krylov space of (K − σM)⁻¹ M, started by the
/// responses (K − σM)⁻¹ L to the loads: four blocks about σ ≈ 0, further ones about σ = −ω_band². Rigid modes
/// come first and are exact.
///
/// @param loads  L (local rows, b) [N], held components 0, the same in every team
/// @param seen   number of leading columns of L that belong to the contact surface. Its flexibility over the
/// band is compared from one block to the next (kernels::flexibility_error). A change is about the error
/// before it; the error after it is estimated as the change times its ratio to the previous change.
/// @return the vectors, distributed among the teams; the certificate holds the estimate. Collective on all
/// ranks.
/// Source: Wilson, Yuan & Dickens 1982 (load-dependent vectors); Gallivan, Grimme & Van Dooren 1996 (rational
/// Krylov spaces match moments at their shifts).
ModeSet contact_basis(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
                      Factorisation& factor, const Eigen::MatrixXd& loads, Eigen::Index seen,
                      const ContactRequest& request, const Progress& progress = {});

/// Frequency above which modes contribute less than `error` to the flexibility over the band if they are
/// represented by the residual flexibility. @param basis  of contact_basis for that band
Hertz needed_up_to(const parallel::Teams& teams, const mesh::Mesh& mesh, const ModeSet& basis,
                   const Eigen::MatrixXd& loads, Eigen::Index seen, Hertz band, double error);

}  // namespace ricochet::modes
