// Internal to src/mesh: one part of a body's mesh as its file has it.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "src/mesh/faces.hpp"
#include "src/mesh/groups.hpp"

namespace ricochet::mesh {

/// The scene's key of surfaces that tractions act on, in messages.
inline constexpr const char* traction_key = "loads.traction.group";

/// What a part has of a group that the scene names.
struct GroupUse {
  std::array<bool, 4> found{};  ///< by dimension
  bool holds = false;           ///< supports: nodes of the body
  Choice choice;                ///< names there are instead, where it was not found
};

/// Nodes are named by gmsh's tags, which all parts share.
struct Part {
  int order = 0;                    ///< 0: no elements of the body
  std::vector<std::int64_t> tag;    ///< (n) of the nodes
  std::vector<double> position;     ///< (n,3) [m], scaled
  std::vector<std::int64_t> fixed;  ///< (n) as in GlobalMesh, by supports of this part
  std::vector<Block> blocks;
  std::vector<Block> contact, loaded;  ///< facets, not yet turned outward
  Faces outside;                       ///< where the part ends: at the body's surface, or at another part
  std::vector<GroupUse> groups;  ///< of the materials, the contact surface, loaded surfaces, the supports
};

/// Reads the file body.mesh as one of `parts`; needs a GmshSession. Throws InputError as read_mesh does, but
/// not for groups that the part does not have.
Part read_part(const scene::Body& body, int parts, const Asked& asked);

/// Throws InputError when a tag occurs twice in `blocks`, which are the body's `key`.
void refuse_repeated(const std::vector<Block>& blocks, const char* what, const char* key,
                     const scene::Body& body);

/// Complaints about the mesh as a whole.
InputError no_elements(const scene::Body& body);
InputError holds_nothing(const scene::Body& body, const std::string& support);
InputError mixed_orders(const scene::Body& body);
InputError foreign_nodes(const scene::Body& body);

}  // namespace ricochet::mesh
