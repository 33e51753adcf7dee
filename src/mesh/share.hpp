// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/mesh: the parts of a split mesh that one rank reads.
#pragma once

#include "src/mesh/part.hpp"

namespace ricochet::mesh {

/// Reads this rank's share of the parts as one. Checks that the parts of all ranks fit together and hold what
/// the scene names. Node tags ascend, nodes of `blocks` are indices into them. Collective; throws InputError
/// on every rank.
Part read_share(const scene::Body& body, const Asked& wanted, MPI_Comm comm,
                const parallel::Progress& progress);

}  // namespace ricochet::mesh
