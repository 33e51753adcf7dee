// SPDX-License-Identifier: BSD-2-Clause
// What is asked of a mode set before anybody sees it.
#pragma once

#include "src/modes/modes.hpp"

namespace ricochet::modes {

/// Makes signs independent of ranks: among entries within 0.1 % of the largest, the first in reading order is
/// positive. Collective on the team.
void fix_signs(const Operators& operators, Eigen::MatrixXd& shape);

/// Residuals and M-orthonormality of what is about to be returned, into `set`; `counted` modes are proved
/// below the cut. Throws SolverError where a bound is not kept. Collective on all ranks.
/// @param tolerance  of residuals; none: they are what they are
void certify(const parallel::Teams& teams, const Operators& operators, std::int64_t counted,
             std::optional<double> tolerance, ModeSet& set);

/// The same for vectors fitted to contact: `error` is the estimate that they have met, `band` where it holds.
/// Throws SolverError when M-orthonormality is worse than 1e-8. Collective on all ranks.
void certify_basis(const parallel::Teams& teams, const Operators& operators, Hertz band, double error,
                   ModeSet& set);

}  // namespace ricochet::modes
