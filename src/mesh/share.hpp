// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/mesh: the parts of a split mesh that one rank reads.
#pragma once

#include "src/mesh/part.hpp"

namespace ricochet::mesh {

/// Reads this rank's share of the parts as one part. Checks that the parts of all ranks fit together and
/// contain the groups of the scene. Node tags ascend; the nodes of `blocks` are indices into them.
/// Collective; throws InputError on every rank.
Part read_share(const scene::Body& body, const RequestedGroups& wanted, MPI_Comm comm,
                const parallel::Progress& progress);

}  // namespace ricochet::mesh
