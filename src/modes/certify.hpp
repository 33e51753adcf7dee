// SPDX-License-Identifier: BSD-2-Clause
// Acceptance checks on a mode set.
#pragma once

#include "src/modes/modes.hpp"

namespace ricochet::modes {

/// Fixes the sign of each column independently of the number of ranks. Among the entries within 0.1 % of the
/// largest, the first in reading order becomes positive. Collective on the team.
void fix_signs(const Operators& operators, Eigen::MatrixXd& shape);

/// Computes residuals and M-orthonormality and stores them in `set`. Throws SolverError if a bound is
/// exceeded or the number of modes is wrong. Collective on all ranks.
/// @param counted    number of modes below the cut, proved by inertia
/// @param tolerance  bound on the residuals; without it, they are only recorded
void certify(const parallel::Teams& teams, const Operators& operators, std::int64_t counted,
             std::optional<double> tolerance, ModeSet& set);

/// Does the same for a contact-adapted basis. `error` is its estimated flexibility error over `band`. Throws
/// SolverError if M-orthonormality is worse than 1e-8. Collective on all ranks.
void certify_basis(const parallel::Teams& teams, const Operators& operators, Hertz band, double error,
                   ModeSet& set);

}  // namespace ricochet::modes
