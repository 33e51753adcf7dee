// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/groups.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmsh.h>

#include <array>
#include <cstdlib>
#include <set>
#include <utility>

namespace ricochet::mesh {

namespace {

/// Whether an entity is an interface between partitions. Interfaces have the group numbers of the entities
/// that they divide, but a lower dimension.
bool is_interface(const EntityKey& key, const Entity& entity) {
  return entity.parent.tag >= 0 && entity.parent.dim != key.dim;
}

const char* kind_of(int dim) {
  return std::array{"point", "line", "surface", "volume"}[static_cast<std::size_t>(dim)];
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

std::string name_of(const EntityKey& entity) { return fmt::format("{} {}", kind_of(entity.dim), entity.tag); }

/// Entities of the physical groups of one dimension, by the name of the group.
std::map<std::string, std::vector<int>> Entities::groups_of(int dim) const {
  std::map<std::string, std::vector<int>> groups;
  for (const auto& [key, entity] : all) {
    if (key.dim != dim || is_interface(key, entity)) continue;
    for (const int number : entity.groups) {
      const auto name = group_name.find({dim, number});
      groups[name == group_name.end() ? std::to_string(number) : name->second].push_back(key.tag);
    }
  }
  return groups;
}

/// Names of the entities of one dimension, by tag, without partitions.
std::map<int, std::string> Entities::names_of(int dim) const {
  std::map<int, std::string> names;
  for (const auto& [key, entity] : all)
    if (key.dim == dim && entity.parent.tag < 0) names[key.tag] = name_of(key);
  return names;
}

/// Returns `entities` and their partitions.
std::vector<int> Entities::with_partitions(int dim, const std::vector<int>& entities) const {
  std::set<int> with(entities.begin(), entities.end());
  for (const auto& [key, entity] : all)
    if (key.dim == dim && entity.parent.dim == dim && with.contains(entity.parent.tag)) with.insert(key.tag);
  return {with.begin(), with.end()};
}

std::vector<int> Entities::find(int dim, const std::string& name) const {
  std::vector<int> entities = std::move(groups_of(dim)[name]);
  if (entities.empty())
    for (const auto& [tag, written] : names_of(dim))
      if (written == name) entities.push_back(tag);
  return with_partitions(dim, entities);
}

Entities::Grouped Entities::grouped(int dim) const {
  Grouped out;
  std::vector<int> whole;
  std::set<int> named;
  for (const auto& [name, entities] : groups_of(dim)) named.insert(entities.begin(), entities.end());
  for (const auto& [tag, name] : names_of(dim))
    if (named.empty() || named.contains(tag))
      whole.push_back(tag);
    else
      out.left_out.push_back(name);
  whole.insert(whole.end(), named.begin(), named.end());  // partitions have groups too
  out.entities = with_partitions(dim, whole);
  return out;
}

std::string Entities::left_out_warning(int dim, const std::string& file, const std::string& body) const {
  const std::vector<std::string> left_out = grouped(dim).left_out;
  if (left_out.empty()) return "";
  return fmt::format(
      "{}: {} of {} belongs to no physical group and is left out, as gmsh does when it saves a mesh: add it "
      "to a group if it is part of the body",
      file, list_of(left_out, 8), body);
}

InputError Entities::no_group(int dim, const std::string& name, const std::string& file,
                              const std::string& key) const {
  std::vector<std::string> groups, entities;
  for (const auto& [group, of_group] : groups_of(dim)) groups.push_back(group);
  for (const auto& [tag, entity] : names_of(dim)) entities.push_back(entity);
  std::string there = "there are none";
  if (!groups.empty())
    there = "the groups are " + list_of(groups, groups.size());
  else if (!entities.empty())
    there = "there are no groups, but " + list_of(entities, 8);
  return InputError(fmt::format("{}: no physical {} \"{}\": {}. Name one in gmsh, or change {}.", file,
                                kind_of(dim), name, there, key));
}

Entities entities_of_model() {
  Entities model;
  gmsh::vectorpair pairs;
  gmsh::model::getEntities(pairs);
  for (const auto& [dim, tag] : pairs) {
    Entity& entity = model.all[{dim, tag}];
    gmsh::model::getPhysicalGroupsForEntity(dim, tag, entity.groups);
    for (int& number : entity.groups) number = std::abs(number);
    gmsh::model::getParent(dim, tag, entity.parent.dim, entity.parent.tag);
  }
  gmsh::model::getPhysicalGroups(pairs);
  for (const auto& [dim, number] : pairs) {
    std::string name;
    gmsh::model::getPhysicalName(dim, number, name);
    if (!name.empty()) model.group_name[{dim, number}] = name;
  }
  return model;
}

}  // namespace ricochet::mesh
