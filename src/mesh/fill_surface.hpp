// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/mesh: a volume inside a surface of triangles (.stl).
#pragma once

#include <string>

namespace ricochet::mesh {

/// Gives gmsh's current model, which holds the triangles of closed surfaces, a volume inside them. A surface
/// inside another one bounds a cavity. The triangles stay as they are; gmsh's mesh generator then fills the
/// volume.
/// @param file  name for messages
/// Throws InputError unless two triangles meet at each edge.
void fill_surface(const std::string& file);

}  // namespace ricochet::mesh
