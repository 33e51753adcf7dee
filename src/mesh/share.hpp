// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/mesh: reads the parts of a partitioned mesh that belong to one rank.
#pragma once

#include "src/mesh/part.hpp"

namespace ricochet::mesh {

/// Reads this rank's share of the parts and merges them into one part. Checks that the parts of all ranks fit
/// together and contain the groups of the scene. In the result, node tags ascend, and the nodes of `blocks`
/// are indices into them. Collective; throws InputError on every rank.
Part read_share(const scene::Body& body, const RequestedGroups& wanted, MPI_Comm comm,
                const parallel::Progress& progress);

}  // namespace ricochet::mesh
