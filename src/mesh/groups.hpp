// SPDX-License-Identifier: BSD-2-Clause
// Names of parts of a body, as gmsh's open model knows them.
#pragma once

#include <string>
#include <vector>

#include "ricochet/error.hpp"

namespace ricochet::mesh {

/// Names that there are in one dimension.
struct Choice {
  std::vector<std::string> groups, entities;  ///< entities as "surface 3", where there are no groups
};
Choice choice_of(int dim);

/// Entities of a physical group, or the one that a name like "surface 3" means where no group has that name:
/// files of CAD programs have no groups. Partitions of an entity count with it. Empty where there is none.
std::vector<int> find_entities(int dim, const std::string& name);

/// find_entities; throws InputError with the names that there are when it finds none.
/// @param file  names the mesh in the message
/// @param key   of the scene, as in "bodies.upper.contact"
std::vector<int> entities_of(int dim, const std::string& name, const std::string& file,
                             const std::string& key);

/// The complaint of entities_of.
InputError no_group(int dim, const std::string& name, const Choice& choice, const std::string& file,
                    const std::string& key);

}  // namespace ricochet::mesh
