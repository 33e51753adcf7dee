// SPDX-License-Identifier: BSD-2-Clause
// Pieces of a body: elements that hang together through faces.
#pragma once

#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// Sets `pieces`, `piece` and `joint` of a distributed mesh. The pieces are the same for any number of ranks.
/// Nothing is set for rods and bodies without elements. Collective.
void find_pieces(Mesh& mesh);

}  // namespace ricochet::mesh
