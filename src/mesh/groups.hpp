// SPDX-License-Identifier: BSD-2-Clause
// Names of groups and entities in the open gmsh model.
#pragma once

#include <string>
#include <vector>

#include "ricochet/error.hpp"

namespace ricochet::mesh {

/// Returns the names in quotes. If there are more than `most`, "…" replaces the names between the first ones
/// and the last.
std::string list_of(std::vector<std::string> names, std::size_t most);

/// The available names in one dimension.
struct Choice {
  std::vector<std::string> groups, entities;  ///< entities ("surface 3") if there are no groups
};
Choice choice_of(int dim);

/// Returns the entities of a physical group; empty if there are none. Files of CAD programs have no groups,
/// so a name such as "surface 3" denotes one entity if no group has that name. Partitions of an entity are
/// included.
std::vector<int> find_entities(int dim, const std::string& name);

/// The entities of one dimension, with partitions, that belong to a physical group if any is there, otherwise
/// all. gmsh saves no others in a mesh either.
struct Grouped {
  std::vector<int> entities;
  std::vector<std::string> left_out;  ///< names such as "volume 2", without partitions
};
Grouped grouped_entities(int dim);

/// Returns the error for a missing group; its message lists the available names.
/// @param file  name of the mesh
/// @param key   key of the scene, such as "bodies.upper.contact"
InputError no_group(int dim, const std::string& name, const Choice& choice, const std::string& file,
                    const std::string& key);

}  // namespace ricochet::mesh
