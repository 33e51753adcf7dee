// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/mesh: the part of the mesh of a body that one rank holds before nodes are numbered.
#pragma once

#include <vector>

#include "src/mesh/faces.hpp"

namespace ricochet::mesh {

/// Key of the scene for surfaces under tractions; used in messages.
inline constexpr const char* traction_key = "loads.traction.group";

/// One part of a mesh. Nodes are identified by their tags in gmsh. The element types of blocks are the same
/// on every rank.
struct Part {
  int order = 0;
  std::vector<std::int64_t> tag;    ///< (n) tags of the nodes, ascending
  std::vector<double> position;     ///< (n,3) [m], scaled
  std::vector<std::int64_t> fixed;  ///< (n) as in GlobalMesh
  std::vector<Block> blocks;        ///< of the elements of this part; Block::node: indices into `tag`
  Faces outside;  ///< faces on the boundary of the body or next to another part; nodes as in `blocks`
  /// Facets in any part, by the tags of their nodes, not yet oriented. If the contact surface is the whole
  /// boundary, `contact` holds those of all faces in `outside`.
  std::vector<Block> contact, loaded;
  bool touches_everywhere = false;  ///< whether the contact surface is the whole boundary
};

}  // namespace ricochet::mesh
