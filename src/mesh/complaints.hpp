// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/mesh: errors that several readers of meshes report.
#pragma once

#include <string>
#include <vector>

#include "ricochet/error.hpp"
#include "src/mesh/mesh.hpp"

namespace ricochet::mesh {

/// Throws InputError if a tag occurs twice in `blocks`, which belong to `key` of the body.
void refuse_repeated(const std::vector<Block>& blocks, const char* what, const char* key,
                     const scene::Body& body);

/// Returns the bit of GlobalMesh::fixed that marks a moving support, or 0 if the support does not move.
/// Throws InputError if there are more moving supports than bits.
unsigned moved_bit(const scene::Body& body, const RequestedGroups& asked, const std::string& support);

/// Returns the element of a gmsh type. Throws InputError with the name of the file if it is not supported.
ReferenceElement checked_reference(int gmsh_type, const std::string& file);

/// Throws InputError if the contact surface is the whole boundary (faces.hpp) and more.
void refuse_more_than_all(const scene::Body& body);

/// Returns the error of an element or entity in two groups that `key` of the body lists.
InputError in_two_groups(const std::string& what, const char* key, const scene::Body& body);

/// Errors about the mesh as a whole.
InputError no_volume(int dim, const std::string& file);  ///< the highest dimension of elements is `dim`
InputError no_elements(const scene::Body& body);
InputError holds_nothing(const scene::Body& body, const std::string& support);
InputError mixed_orders(const scene::Body& body);
InputError foreign_nodes(const scene::Body& body);

}  // namespace ricochet::mesh
