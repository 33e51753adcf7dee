// SPDX-License-Identifier: BSD-2-Clause
// Acceptance checks on a mode set.
#pragma once

#include "src/modes/modes.hpp"
#include "src/modes/slicing.hpp"

namespace ricochet::modes {

/// Fixes the sign of each column independently of the number of ranks. Among the entries within 0.1 % of the
/// largest, the first in reading order becomes positive. Collective on the team.
void fix_signs(const Operators& operators, Eigen::MatrixXd& shape);

/// Fills the certificate of a set and its residuals, both from the set itself: residuals and M-orthonormality
/// from K and M, and the number of its modes below each shift, for comparison with the inertia there.
/// @param counts     shifts with their inertia, ascending; the last one at the end of the set
/// @param tolerance  bound on the residuals, unless round-off explains them
/// @param changed    modes whose residuals and products are computed, ascending; without it, all
/// @return the modes whose residual or M-orthonormality exceeds its bound. Collective on all ranks.
std::vector<Eigen::Index> certify(const parallel::Teams& teams, const Operators& operators,
                                  const std::vector<Probe>& counts, double tolerance, ModeSet& set,
                                  const std::optional<std::vector<Eigen::Index>>& changed = {});

/// Throws SolverError unless the certificate is complete.
/// @param doubtful  from `certify`
void refuse_incomplete(const ModeSet& set, const std::vector<Eigen::Index>& doubtful);

/// Counts the eigenvalues below a shift by a factorisation in the first team, which raises a shift that
/// equals an eigenvalue. Collective on all ranks.
Probe count_below(const parallel::Teams& teams, Factorisation& factor, double sigma);

/// Certifies a contact-adapted basis. `error` is its estimated flexibility error over `band`. Throws
/// SolverError if M-orthonormality is worse than 1e-8. Collective on all ranks.
void certify_basis(const parallel::Teams& teams, const Operators& operators, Hertz band, double error,
                   ModeSet& set);

}  // namespace ricochet::modes
