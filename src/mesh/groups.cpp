// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/groups.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmsh.h>

#include <array>
#include <map>
#include <set>
#include <utility>

namespace ricochet::mesh {

namespace {

/// Returns the dimension and tag of the entity from which a partition, or an interface between partitions,
/// was created; −1 if there is none.
std::pair<int, int> parent_of(int dim, int tag) {
  std::pair<int, int> parent{-1, -1};
  gmsh::model::getParent(dim, tag, parent.first, parent.second);
  return parent;
}

/// Whether an entity is an interface between partitions. Interfaces have the group numbers of the entities
/// that they divide, but a lower dimension.
bool is_interface(int dim, int tag) {
  const auto [above, parent] = parent_of(dim, tag);
  return parent >= 0 && above != dim;
}

/// Entities of the physical groups of one dimension, by the name of the group.
std::map<std::string, std::vector<int>> groups_of(int dim) {
  gmsh::vectorpair pairs;
  gmsh::model::getPhysicalGroups(pairs, dim);
  std::map<std::string, std::vector<int>> groups;
  for (const auto& [d, tag] : pairs) {
    std::string name;
    gmsh::model::getPhysicalName(d, tag, name);
    std::vector<int> entities;
    gmsh::model::getEntitiesForPhysicalGroup(dim, tag, entities);
    std::erase_if(entities, [&](int entity) { return is_interface(dim, entity); });
    if (!entities.empty()) groups[name.empty() ? std::to_string(tag) : name] = std::move(entities);
  }
  return groups;
}

const char* kind_of(int dim) {
  return std::array{"point", "line", "surface", "volume"}[static_cast<std::size_t>(dim)];
}

/// Names of all entities of one dimension, such as "surface 3", by tag.
std::map<int, std::string> entity_names(int dim) {
  gmsh::vectorpair pairs;
  gmsh::model::getEntities(pairs, dim);
  std::map<int, std::string> names;
  for (const auto& [d, tag] : pairs)
    if (parent_of(d, tag).second < 0) names[tag] = fmt::format("{} {}", kind_of(dim), tag);
  return names;
}

/// Returns `entities` and their partitions.
std::vector<int> with_partitions(int dim, const std::vector<int>& entities) {
  std::set<int> all(entities.begin(), entities.end());
  gmsh::vectorpair pairs;
  gmsh::model::getEntities(pairs, dim);
  for (const auto& [d, tag] : pairs)
    if (const auto [above, parent] = parent_of(d, tag); above == dim && all.count(parent) > 0)
      all.insert(tag);
  return {all.begin(), all.end()};
}

}  // namespace

std::string list_of(std::vector<std::string> names, std::size_t most) {
  for (std::string& name : names) name = '"' + name + '"';
  if (names.size() > most) {
    names[most - 2] = "…";
    names.erase(names.begin() + static_cast<std::ptrdiff_t>(most) - 1, names.end() - 1);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

Choice choice_of(int dim) {
  Choice choice;
  for (const auto& [name, entities] : groups_of(dim)) choice.groups.push_back(name);
  if (choice.groups.empty())
    for (const auto& [tag, name] : entity_names(dim)) choice.entities.push_back(name);
  return choice;
}

Grouped grouped_entities(int dim) {
  Grouped out;
  std::vector<int> whole;
  std::set<int> named;
  for (const auto& [name, entities] : groups_of(dim)) named.insert(entities.begin(), entities.end());
  for (const auto& [tag, name] : entity_names(dim))
    if (named.empty() || named.contains(tag))
      whole.push_back(tag);
    else
      out.left_out.push_back(name);
  whole.insert(whole.end(), named.begin(), named.end());  // partitions have groups too
  out.entities = with_partitions(dim, whole);
  return out;
}

InputError no_group(int dim, const std::string& name, const Choice& choice, const std::string& file,
                    const std::string& key) {
  std::string there = "there are none";
  if (!choice.groups.empty())
    there = "the groups are " + list_of(choice.groups, choice.groups.size());
  else if (!choice.entities.empty())
    there = "there are no groups, but " + list_of(choice.entities, 8);
  return InputError(fmt::format("{}: no physical {} \"{}\": {}. Name one in gmsh, or change {}.", file,
                                kind_of(dim), name, there, key));
}

std::vector<int> find_entities(int dim, const std::string& name) {
  auto groups = groups_of(dim);
  std::vector<int> entities = std::move(groups[name]);
  if (entities.empty())
    for (const auto& [tag, written] : entity_names(dim))
      if (written == name) entities.push_back(tag);
  return with_partitions(dim, entities);
}

}  // namespace ricochet::mesh
