// SPDX-License-Identifier: BSD-2-Clause
// The Coriolis coupling of nearly equal modes.
#pragma once

#include "src/modes/modes.hpp"

namespace ricochet::reduction {

/// Returns ∫ρ φ_m × φ_n of all pairs of nearly equal elastic modes of a solid, the same on every rank.
/// Collective on all ranks.
/// @param mass  M of the team without supports, with 3 components; its blocks are multiples of the identity
kernels::Coriolis coriolis(const parallel::Teams& teams, Mat mass, const modes::ModeSet& set);

}  // namespace ricochet::reduction
