// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/uses.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "src/mesh/complaints.hpp"
#include "src/mesh/part.hpp"

namespace ricochet::mesh {

namespace {

class Finder {
 public:
  Finder(const MshFiles& files, const scene::Body& body)
      : entities_(files.entities), body_(body), file_(body.mesh.filename().string()) {}

  std::vector<int> find(int dim, const std::string& group, const std::string& key) const {
    std::vector<int> found = entities_.find(dim, group);
    if (found.empty()) throw entities_.no_group(dim, group, file_, key);
    return found;
  }

  Labels labels(int dim, const std::vector<std::string>& groups, const std::string& key) const {
    Labels labels;
    for (std::size_t g = 0; g < groups.size(); ++g)
      for (const int entity : groups[g].empty() ? entities_.grouped(dim).entities : find(dim, groups[g], key))
        labels[entity].push_back(static_cast<std::int64_t>(g));
    return labels;
  }

  void refuse_two(int dim, const Labels& labels, const char* key) const {
    for (const auto& [entity, groups] : labels)
      if (groups.size() > 1) throw in_two_groups(name_of({dim, entity}), key, body_);
  }

 private:
  const Entities& entities_;
  const scene::Body& body_;
  std::string file_;
};

}  // namespace

bool Uses::contains(const EntityKey& entity) const {
  return support.contains(entity) || (entity.dim == 3 && material.contains(entity.tag)) ||
         (entity.dim == 2 && (contact.contains(entity.tag) || loaded.contains(entity.tag)));
}

bool touches_everywhere(const scene::Body& body, const Entities& entities) {
  return std::ranges::count(body.contact, whole_boundary) > 0 && entities.find(2, whole_boundary).empty();
}

Uses uses_of(const MshFiles& files, const scene::Body& body, const RequestedGroups& wanted) {
  const std::string start = "bodies." + body.name + '.', file = body.mesh.filename().string();
  const Finder finder(files, body);
  Uses uses;
  std::vector<std::string> materials;
  for (const scene::Material& material : body.materials) materials.push_back(material.group);
  uses.material = finder.labels(3, materials, start + "material");
  finder.refuse_two(3, uses.material, "material");
  for (const MshOutline& outline : files.outline)
    for (const MshElements& block : outline.elements) {
      if (block.entity.dim != 3 || !uses.material.contains(block.entity.tag) || block.list.count == 0)
        continue;
      const int order = checked_reference(block.gmsh_type, file).order;
      if (uses.order != 0 && order != uses.order) throw mixed_orders(body);
      uses.order = order;
    }
  if (uses.order == 0) throw no_elements(body);

  uses.touches_everywhere = touches_everywhere(body, files.entities);
  if (uses.touches_everywhere)
    refuse_more_than_all(body);
  else
    uses.contact = finder.labels(2, body.contact, start + "contact");
  finder.refuse_two(2, uses.contact, "contact");
  uses.loaded = finder.labels(2, wanted.loaded, traction_key);

  if (body.support.size() > 62)
    throw InputError(
        fmt::format("{}: more than 62 supports of bodies.{}: join some in one group", file, body.name));
  std::int64_t bit = 1;
  for (const auto& [name, components] : body.support) {
    int dim = 3;
    while (dim >= 0 && files.entities.find(dim, name).empty()) --dim;
    if (dim < 0) dim = 2;  // for the error message
    for (const int entity : finder.find(dim, name, start + "support")) uses.support[{dim, entity}] |= bit;
    bit *= 2;
  }
  return uses;
}

}  // namespace ricochet::mesh
