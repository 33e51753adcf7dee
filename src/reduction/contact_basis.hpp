// SPDX-License-Identifier: BSD-2-Clause
// Contact-adapted basis: load-dependent Ritz vectors.
#pragma once

#include "src/modes/modes.hpp"

namespace ricochet::reduction {

struct ContactRequest {
  Hertz band{};                         ///< frequencies at which the flexibility must be accurate
  double flexibility_error = 1e-3;      ///< bound on the estimated error; not used with `count`
  std::optional<std::int64_t> count{};  ///< number of vectors, rigid modes included
  bool residual_flexibility = true;     ///< whether the caller adds the static correction
};

/// The first shift of contact_basis [rad²/s²]. K − σM is definite, so rigid modes are harmless, and σ is
/// negligible for the elastic modes.
double shift_near_zero(Hertz band);

/// Computes Ritz vectors of K φ = ω² M φ in the block rational Krylov space of (K − σM)⁻¹ M, which starts
/// with the responses (K − σM)⁻¹ L to the loads. The first four blocks, or more, use σ ≈ 0. If that saves
/// blocks, or with `count`, further blocks use σ = −ω_band². Rigid modes come first and are exact.
///
/// The flexibility of the contact surface over the band is compared from one block to the next
/// (kernels::flexibility_error). The change is about the error before the block. The error after it is
/// estimated as the change times its ratio to the previous change.
///
/// @param loads  L (local rows, b) [N], fixed components 0, the same in every team
/// @param seen   number of leading columns of L that belong to the contact surface
/// @return the vectors, distributed among the teams; the certificate holds the estimate. Collective on all
/// ranks.
/// Source: Wilson, Yuan & Dickens 1982 (load-dependent vectors); Gallivan, Grimme & Van Dooren 1996 (rational
/// Krylov spaces match moments at their shifts).
modes::ModeSet contact_basis(const parallel::Teams& teams, const mesh::Mesh& mesh,
                             const elasticity::Body& body, modes::Factorisation& factor,
                             const Eigen::MatrixXd& loads, Eigen::Index seen, const ContactRequest& request,
                             const modes::Progress& progress = {});

/// Peak memory of contact_basis on this rank, in addition to K, M and the loads [MiB]: factors, and several
/// copies of the block of responses to all loads, or the space with its Ritz vectors. If their number is
/// unknown, the space is left out; contact_basis then refuses to grow beyond the memory.
/// @param loads  b   @param count  number of vectors; 0: unknown
double expected_basis_mib(const modes::Factorisation& factor, std::int64_t local_rows, std::int64_t loads,
                          std::int64_t count);

/// Returns the frequency above which the residual flexibility can replace modes: the error in the flexibility
/// over the band is then less than `error`.
/// @param basis  result of contact_basis for that band
Hertz needed_up_to(const parallel::Teams& teams, const mesh::Mesh& mesh, const modes::ModeSet& basis,
                   const Eigen::MatrixXd& loads, Eigen::Index seen, Hertz band, double error);

}  // namespace ricochet::reduction
