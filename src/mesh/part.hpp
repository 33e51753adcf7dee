// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/mesh: one part of the mesh of a body, as stored in its file.
#pragma once

#include <array>
#include <vector>

#include "src/mesh/faces.hpp"
#include "src/mesh/groups.hpp"

namespace ricochet::mesh {

/// Key of the scene for surfaces under tractions; used in messages.
inline constexpr const char* traction_key = "loads.traction.group";

/// Occurrence of one group of the scene in a part.
struct GroupUse {
  std::array<bool, 4> found{};  ///< for each dimension
  bool holds = false;           ///< for a support: whether it contains nodes of the body
  Choice choice;                ///< available names if the group was not found
};

/// One part of a mesh. Nodes are identified by their tags in gmsh, which are the same in all parts.
struct Part {
  int order = 0;                    ///< 0 if there are no elements of the body
  std::vector<std::int64_t> tag;    ///< (n) tags of the nodes
  std::vector<double> position;     ///< (n,3) [m], scaled
  std::vector<std::int64_t> fixed;  ///< (n) as in GlobalMesh, for supports of this part
  std::vector<Block> blocks;
  std::vector<Block> contact, loaded;  ///< facets, not yet oriented
  /// Whether the contact surface is the whole boundary. `contact` then holds the facets of all faces in
  /// `outside`.
  bool touches_everywhere = false;
  Faces outside;  ///< faces on the boundary of the body or next to another part
  /// Groups of the materials, the contact surface, the loaded surfaces and the supports, in this order.
  std::vector<GroupUse> groups;
};

}  // namespace ricochet::mesh
