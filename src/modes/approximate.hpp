// SPDX-License-Identifier: BSD-2-Clause
// Modes from those of a lower element order by block inverse iteration: approximate, their number proved.
#pragma once

#include "src/modes/modes.hpp"

namespace ricochet::modes {

struct ApproximateRequest {
  std::optional<Hertz> up_to{};  ///< all modes up to here, or
  std::optional<std::int64_t>
      count{};  ///< the lowest ones, rigid included; modes as close as 1e-3 stay together
  int iterations = 1;
};

/// Ritz vectors that stand for the lowest modes. Each is M-orthonormal to the others, K-orthogonal too, and
/// its λ lies above that of the mode it stands for; as many as inertia counts, so that none is missing.
///
/// The modes of the next lower order on the same elements, and some more of them, are raised to this one;
/// each iteration solves (K − σM) Y = M X about a σ < 0 near zero for all of them and projects K and M on Y.
///
/// @param materials, file  as in elasticity::assemble, for the lower order
/// @return the columns shared out among the teams. Collective on all ranks; needs a GmshSession.
/// Throws InputError when the lower order has too few displacements; SolverError when the counts do not agree
/// after three further iterations.
/// Source: Bathe & Wilson 1972 (subspace iteration); start from a coarser space as in nested iteration. That
/// the j-th Ritz value bounds the j-th eigenvalue is the min-max theorem: as many Ritz values as eigenvalues
/// below a shift then prove that each of these has its own.
ModeSet approximate_modes(const parallel::Teams& teams, const mesh::Mesh& mesh, const elasticity::Body& body,
                          Factorisation& factor, const std::vector<scene::Material>& materials,
                          const std::string& file, const ApproximateRequest& request,
                          const Progress& progress = {});

/// Memory that this needs on this rank at its peak, beside K and M [MiB]; `modes` 0: not known.
double expected_approximate_mib(const Factorisation& factor, std::int64_t local_rows, std::int64_t modes,
                                int teams);

}  // namespace ricochet::modes
