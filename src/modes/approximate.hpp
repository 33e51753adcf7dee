// SPDX-License-Identifier: BSD-2-Clause
// Approximate modes from those of the next lower element order by block inverse iteration, with an exact
// count.
#pragma once

#include "src/modes/modes.hpp"

namespace ricochet::modes {

struct ApproximateRequest {
  std::optional<Hertz> up_to{};  ///< all modes up to here, or
  /// The lowest ones, rigid modes included. Modes closer than 1e-3 are not separated.
  std::optional<std::int64_t> count{};
  int iterations = 1;
};

/// Ritz vectors that approximate the lowest modes. They are M-orthonormal and K-orthogonal, and the λ of each
/// lies above that of the mode it approximates. Their number equals the Sturm-sequence (inertia) count, so
/// that none is missing.
///
/// The modes of the next lower order on the same elements, and some more of them, are prolonged to this
/// order. Each iteration solves (K − σM) Y = M X about a σ < 0 near zero for all of them and projects K and M
/// on Y.
///
/// @param materials, file  as in elasticity::assemble, for the lower order
/// @return the columns, distributed among the teams. Collective on all ranks; needs a GmshSession.
/// Throws InputError if the lower order has too few displacements; SolverError if the counts do not agree
/// after three further iterations.
/// Source: Bathe & Wilson 1972 (subspace iteration); the start from a coarser space is that of nested
/// iteration. By the min-max theorem the j-th Ritz value bounds the j-th eigenvalue from above: if there are
/// as many Ritz values as eigenvalues below a shift, each of these eigenvalues has its own.
ModeSet approximate_modes(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
                          Factorisation& factor, const std::vector<scene::Material>& materials,
                          const std::string& file, const ApproximateRequest& request,
                          const Progress& progress = {});

/// Peak memory of this computation on this rank, in addition to K and M [MiB]; `modes` 0: unknown.
double expected_approximate_mib(const Factorisation& factor, std::int64_t local_rows, std::int64_t modes,
                                int teams);

}  // namespace ricochet::modes
