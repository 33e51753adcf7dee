// SPDX-License-Identifier: BSD-2-Clause
// Entities of a mesh, their physical groups, and the names of both.
#pragma once

#include <compare>
#include <map>
#include <string>
#include <vector>

#include "ricochet/error.hpp"

namespace ricochet::mesh {

/// Identifies an entity of gmsh, or a physical group by its number.
struct EntityKey {
  int dim = 0, tag = 0;
  auto operator<=>(const EntityKey&) const = default;
};

struct Entity {
  std::vector<int> groups;      ///< numbers of its physical groups
  EntityKey parent = {-1, -1};  ///< of a partition: the entity that it divides. Otherwise, negative
};

/// Returns the names in quotes. If there are more than `most`, "…" replaces the names between the first ones
/// and the last.
std::string list_of(std::vector<std::string> names, std::size_t most);

/// Returns the name of an entity, such as "surface 3".
std::string name_of(const EntityKey& entity);

/// The entities of a mesh or geometry.
struct Entities {
  std::map<EntityKey, Entity> all;
  std::map<EntityKey, std::string> group_name;

  /// Returns the entities of a physical group; empty if there are none. Files of CAD programs have no groups,
  /// so a name such as "surface 3" denotes one entity if no group has that name. Partitions of an entity are
  /// included.
  std::vector<int> find(int dim, const std::string& name) const;

  /// The entities of one dimension, with partitions, that belong to a physical group if any is there,
  /// otherwise all. gmsh saves no others in a mesh either.
  struct Grouped {
    std::vector<int> entities;
    std::vector<std::string> left_out;  ///< names such as "volume 2", without partitions
  };
  Grouped grouped(int dim) const;

  /// Returns the warning about `left_out` of a body whose material names no group; empty without any.
  /// @param file  name of the mesh
  std::string left_out_warning(int dim, const std::string& file, const std::string& body) const;

  /// Returns the error for a missing group; its message lists the available names.
  /// @param file  name of the mesh
  /// @param key   key of the scene, such as "bodies.upper.contact"
  InputError no_group(int dim, const std::string& name, const std::string& file,
                      const std::string& key) const;

 private:
  std::map<std::string, std::vector<int>> groups_of(int dim) const;
  std::map<int, std::string> names_of(int dim) const;
  std::vector<int> with_partitions(int dim, const std::vector<int>& entities) const;
};

/// Returns the entities of the open gmsh model.
Entities entities_of_model();

}  // namespace ricochet::mesh
