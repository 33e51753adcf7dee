// SPDX-License-Identifier: BSD-2-Clause
// Names of the parts of a body in the open gmsh model.
#pragma once

#include <string>
#include <vector>

#include "ricochet/error.hpp"

namespace ricochet::mesh {

/// The names in one dimension.
struct Choice {
  std::vector<std::string> groups, entities;  ///< entities, as "surface 3", if there are no groups
};
Choice choice_of(int dim);

/// Entities of a physical group. If no group has that name, a name like "surface 3" denotes one entity,
/// because files of CAD programs have no groups. Partitions of an entity belong to it. Empty if there is
/// none.
std::vector<int> find_entities(int dim, const std::string& name);

/// The error for a group that is not found, with the available names.
/// @param file  name of the mesh
/// @param key   key of the scene, such as "bodies.upper.contact"
InputError no_group(int dim, const std::string& name, const Choice& choice, const std::string& file,
                    const std::string& key);

}  // namespace ricochet::mesh
