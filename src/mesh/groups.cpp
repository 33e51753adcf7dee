#include "src/mesh/groups.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmsh.h>

#include <array>
#include <map>

#include "kernels/error.hpp"

namespace ricochet::mesh {

namespace {

/// gmsh's physical groups of one dimension, by name.
std::map<std::string, int> groups_of(int dim) {
  gmsh::vectorpair pairs;
  gmsh::model::getPhysicalGroups(pairs, dim);
  std::map<std::string, int> groups;
  for (const auto& [d, tag] : pairs) {
    std::string name;
    gmsh::model::getPhysicalName(d, tag, name);
    groups[name.empty() ? std::to_string(tag) : name] = tag;
  }
  return groups;
}

const char* kind_of(int dim) {
  return std::array{"point", "line", "surface", "volume"}[static_cast<std::size_t>(dim)];
}

/// Every entity of one dimension as "surface 3", by tag.
std::map<int, std::string> entity_names(int dim) {
  gmsh::vectorpair pairs;
  gmsh::model::getEntities(pairs, dim);
  std::map<int, std::string> names;
  for (const auto& [d, tag] : pairs) names[tag] = fmt::format("{} {}", kind_of(dim), tag);
  return names;
}

/// The names that could have been meant, quoted.
std::string choice(int dim) {
  std::vector<std::string> names;
  for (const auto& [name, tag] : groups_of(dim)) names.push_back('"' + name + '"');
  if (!names.empty()) return fmt::format("the groups are {}", fmt::join(names, ", "));
  for (const auto& [tag, name] : entity_names(dim)) names.push_back('"' + name + '"');
  if (names.empty()) return "there are none";
  if (names.size() > 8) {
    names[6] = "…";
    names.erase(names.begin() + 7, names.end() - 1);
  }
  return fmt::format("there are no groups, but {}", fmt::join(names, ", "));
}

}  // namespace

std::vector<int> find_entities(int dim, const std::string& name) {
  std::vector<int> entities;
  const auto groups = groups_of(dim);
  if (const auto found = groups.find(name); found != groups.end()) {
    gmsh::model::getEntitiesForPhysicalGroup(dim, found->second, entities);
    return entities;
  }
  for (const auto& [tag, written] : entity_names(dim))
    if (written == name) entities.push_back(tag);
  return entities;
}

std::vector<int> entities_of(int dim, const std::string& name, const std::string& file,
                             const std::string& key) {
  std::vector<int> entities = find_entities(dim, name);
  if (entities.empty())
    throw InputError(fmt::format("{}: no physical {} \"{}\": {}. Name one in gmsh, or change {}.", file,
                                 kind_of(dim), name, choice(dim), key));
  return entities;
}

}  // namespace ricochet::mesh
