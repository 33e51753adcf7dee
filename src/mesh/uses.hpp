// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/mesh: what a scene uses the entities of a mesh for.
#pragma once

#include <map>

#include "src/mesh/mesh.hpp"
#include "src/mesh/msh_files.hpp"

namespace ricochet::mesh {

/// Block::label of the elements or facets of an entity, by its tag. A loaded surface may have several.
using Labels = std::map<int, std::vector<std::int64_t>>;

struct Uses {
  int order = 0;  ///< of the elements
  Labels material, contact, loaded;
  bool touches_everywhere = false;  ///< the contact surface is the whole boundary; `contact` is empty
  std::map<EntityKey, std::int64_t> support;  ///< bit s: the s-th support of the scene holds this entity

  bool contains(const EntityKey& entity) const;
};

/// Whether the contact surface of a solid is its whole boundary. Another mesh may have a group of this name.
bool touches_everywhere(const scene::Body& body, const Entities& entities);

/// Finds the groups of the scene in a mesh of volumes. Throws InputError if one is missing, an entity has two
/// materials or contact groups, no elements are left, or their orders differ or are not supported.
Uses uses_of(const MshFiles& files, const scene::Body& body, const RequestedGroups& wanted);

}  // namespace ricochet::mesh
