// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/mesh: one part of a body's mesh, as in its file.
#pragma once

#include <array>
#include <vector>

#include "src/mesh/faces.hpp"
#include "src/mesh/groups.hpp"

namespace ricochet::mesh {

/// Key of the scene for surfaces under tractions, in messages.
inline constexpr const char* traction_key = "loads.traction.group";

/// Occurrence in a part of a group that the scene names.
struct GroupUse {
  std::array<bool, 4> found{};  ///< by dimension
  bool holds = false;           ///< supports: nodes of the body
  Choice choice;                ///< available names, if it was not found
};

/// Nodes are identified by gmsh's tags, which all parts share.
struct Part {
  int order = 0;                    ///< 0: no elements of the body
  std::vector<std::int64_t> tag;    ///< (n) of the nodes
  std::vector<double> position;     ///< (n,3) [m], scaled
  std::vector<std::int64_t> fixed;  ///< (n) as in GlobalMesh, by supports of this part
  std::vector<Block> blocks;
  std::vector<Block> contact, loaded;  ///< facets, not yet oriented
  Faces outside;                       ///< faces on the boundary of the body or next to another part
  std::vector<GroupUse> groups;  ///< of the materials, the contact surface, loaded surfaces, the supports
};

}  // namespace ricochet::mesh
