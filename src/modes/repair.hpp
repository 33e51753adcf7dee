// SPDX-License-Identifier: BSD-2-Clause
// Improvement of modes whose residual or orthogonality exceeds its bound.
#pragma once

#include "src/modes/modes.hpp"

namespace ricochet::modes {

/// Improves these modes, given by number, by subspace iteration about shifts near them, with a Rayleigh–Ritz
/// projection in each step. Each team improves its own. Neighbours take part, because the components of
/// nearest modes decay most slowly; multiple modes are kept whole. Collective on all ranks of `teams`.
///
/// The lowest modes of a thin body lie thousands of times their own λ below the shift of their slice, so that
/// the round-off of its solves matters. About a shift σ < 0 near zero, it does not.
/// @return the numbers of `modes` and of all others that were changed
std::vector<Eigen::Index> repair(const parallel::Teams& teams, const Operators& operators,
                                 Factorisation& factor, const std::vector<Eigen::Index>& modes, ModeSet& set);

}  // namespace ricochet::modes
