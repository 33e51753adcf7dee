// SPDX-License-Identifier: BSD-2-Clause
// Repair of curved elements that gmsh inverts.
#pragma once

#include <string>
#include <unordered_map>

#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// Repairs a mesh that gmsh has made of a geometry, and that is still its current model. gmsh curves elements
/// along the surface, which inverts some where the surface bends sharply. Its optimiser, which bends the mesh
/// like an elastic body, repairs most of them; the rest is straightened, with a warning in the mesh.
/// @param file   name for the warning
/// @param index  node of each tag of gmsh
/// @param scale  metres per unit of the geometry
void repair_curved(GlobalMesh& mesh, const std::string& file,
                   const std::unordered_map<std::size_t, std::int64_t>& index, double scale);

}  // namespace ricochet::mesh
