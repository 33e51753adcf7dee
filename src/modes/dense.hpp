// SPDX-License-Identifier: BSD-2-Clause
// Modes of small bodies by the dense solver of LAPACK, which cannot stall.
#pragma once

#include "src/modes/lanczos.hpp"

namespace ricochet::modes {

/// Whether the dense solver takes less time than Lanczos for so many modes. It takes O(rows³), whatever their
/// number.
bool dense_is_faster(std::int64_t rows, std::int64_t modes);

/// Largest body for which the dense solver is tried where Lanczos fails. It takes minutes, and 1 GiB.
inline constexpr std::int64_t most_dense_rows = 5000;

/// Computes the elastic modes in `wanted` from M x = θ (K − σM) x with θ = 1/(λ − σ) on the first rank of the
/// team. About a σ < 0 near zero, the right-hand matrix is positive definite, even with fixed rows, and the
/// lowest modes, for which round-off in K matters most, have the largest θ. Rigid modes are deflated.
/// Collective on the team. Throws SolverError if LAPACK breaks down.
Converged dense_modes(const Operators& operators, const Entries& entries, const Interval& wanted);

}  // namespace ricochet::modes
