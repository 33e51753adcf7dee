// SPDX-License-Identifier: BSD-2-Clause
// Approximate modes by block inverse iteration, which starts from the modes of the next lower element order.
// The number of modes is exact.
#pragma once

#include "src/modes/modes.hpp"

namespace ricochet::modes {

/// Either `up_to` or `count` must be set.
struct ApproximateRequest {
  std::optional<Hertz> up_to{};  ///< all modes up to this frequency
  /// Number of lowest modes, rigid modes included. Modes closer than 1e-3 are not separated.
  std::optional<std::int64_t> count{};
  int iterations = 1;
};

/// Computes Ritz vectors that approximate the lowest modes. They are M-orthonormal and K-orthogonal, and each
/// λ is an upper bound on that of its mode. Their number equals the Sturm-sequence (inertia) count, so that
/// none is missing.
///
/// More modes than requested are computed with the next lower order on the same elements and prolonged to
/// this order. Each iteration solves (K − σM) Y = M X for all of them, with σ < 0 near zero, and projects K
/// and M onto the span of Y.
///
/// @param materials, file  as in elasticity::assemble, for the lower order
/// @return the vectors, distributed among the teams. Collective on all ranks; needs a GmshSession.
/// Throws InputError if the lower order has too few displacements; SolverError if the counts do not agree
/// after three further iterations.
/// Source: Bathe & Wilson 1972 (subspace iteration). Starting from a coarser space is known from nested
/// iteration. By the min-max theorem, the j-th Ritz value is an upper bound on the j-th eigenvalue. If as
/// many Ritz values as eigenvalues lie below a shift, each of these eigenvalues therefore has its own Ritz
/// value.
ModeSet approximate_modes(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
                          Factorisation& factor, const std::vector<scene::Material>& materials,
                          const std::string& file, const ApproximateRequest& request,
                          const Progress& progress = {});

/// Peak memory of this computation on this rank, in addition to K and M [MiB]. `modes` is 0 if unknown.
double expected_approximate_mib(const Factorisation& factor, std::int64_t local_rows, std::int64_t modes,
                                int teams);

}  // namespace ricochet::modes
