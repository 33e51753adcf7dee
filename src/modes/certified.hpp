// SPDX-License-Identifier: BSD-2-Clause
// Search, certificate and repair: the engine of compute_modes and of the solver "ricochet" of SLEPc.
#pragma once

#include "src/modes/checkpoint.hpp"
#include "src/modes/modes.hpp"

namespace ricochet::modes {

/// Computes all requested modes of K and M, in addition to the known ones. `factor` is the factorisation of
/// both. Collective on all ranks of `teams`. Throws SolverError like compute_modes. No uncertified mode is
/// returned.
ModeSet certified_modes(const parallel::Teams& teams, const Operators& operators, Factorisation& factor,
                        const Request& request, const Checkpoint& checkpoint, const Progress& progress);

/// Fills the certificate of a set, and repairs modes that exceed a bound. Collective on all ranks of `teams`.
/// Throws SolverError if that does not help, or if a count disagrees.
/// @param counts  shifts with the eigenvalues of the set below them, ascending; the last one at the end of
/// the set
void hold_to_bounds(const parallel::Teams& teams, const Operators& operators, Factorisation& factor,
                    const std::vector<Probe>& counts, double relative_residual, ModeSet& set);

}  // namespace ricochet::modes
