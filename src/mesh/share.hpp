// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/mesh: reads the part of a mesh that belongs to one rank.
#pragma once

#include "src/mesh/msh_files.hpp"
#include "src/mesh/part.hpp"

namespace ricochet::mesh {

/// Reads a mesh: each rank reads an equal range of the nodes and of the elements, whose ranks are then chosen
/// by `split`. Checks that the files contain the groups of the scene, fit together, and define each node and
/// element once. Collective; throws InputError on every rank.
/// @param peers  ranks in the same place of other teams, which get the same part
Part read_share(const MshFiles& files, const scene::Body& body, const RequestedGroups& wanted, MPI_Comm comm,
                MPI_Comm peers, const parallel::Progress& progress);

}  // namespace ricochet::mesh
