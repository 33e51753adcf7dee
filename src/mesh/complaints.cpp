// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/complaints.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "src/mesh/faces.hpp"

namespace ricochet::mesh {

void refuse_repeated(const std::vector<Block>& blocks, const char* what, const char* key,
                     const scene::Body& body) {
  std::vector<std::int64_t> tags;
  for (const Block& block : blocks) tags.insert(tags.end(), block.tag.begin(), block.tag.end());
  std::sort(tags.begin(), tags.end());
  const auto twice = std::adjacent_find(tags.begin(), tags.end());
  if (twice != tags.end()) throw in_two_groups(fmt::format("{} {}", what, *twice), key, body);
}

InputError in_two_groups(const std::string& what, const char* key, const scene::Body& body) {
  return InputError(fmt::format("{}: {} lies in two groups of bodies.{}.{}: give it to one",
                                body.mesh.filename().string(), what, body.name, key));
}

ReferenceElement checked_reference(int gmsh_type, const std::string& file) {
  try {
    return reference_element(gmsh_type);
  } catch (const InputError& error) {
    throw InputError(file + ": " + error.what());
  }
}

void refuse_more_than_all(const scene::Body& body) {
  if (body.contact.size() > 1)
    throw InputError(
        fmt::format("{}: bodies.{}.contact: \"{}\" is the whole surface of the body: name it alone",
                    body.mesh.filename().string(), body.name, whole_boundary));
}

unsigned moved_bit(const scene::Body& body, const RequestedGroups& asked, const std::string& support) {
  const auto moved = std::ranges::find(asked.moved, support) - asked.moved.begin();
  if (moved == std::ssize(asked.moved)) return 0;
  if (moved >= 29)
    throw InputError(fmt::format("{}: more than 29 supports of bodies.{} move: join some in one group",
                                 body.mesh.filename().string(), body.name));
  return 1U << (3 + moved);
}

InputError no_volume(int dim, const std::string& file) {
  if (dim == 2)
    return InputError(fmt::format(
        "{}: has surface elements but no volume: mesh the volume (gmsh -3) and give it a physical group",
        file));
  return InputError(fmt::format(
      "{}: holds no volume or line elements: mesh it with gmsh first, or name another file", file));
}

InputError no_elements(const scene::Body& body) {
  return InputError(fmt::format("{}: bodies.{}.material: its groups hold no elements: name others",
                                body.mesh.filename().string(), body.name));
}

InputError holds_nothing(const scene::Body& body, const std::string& support) {
  return InputError(fmt::format("{}: bodies.{}.support.{} holds no node of the body: name a group on it",
                                body.mesh.filename().string(), body.name, support));
}

InputError mixed_orders(const scene::Body& body) {
  return InputError(
      fmt::format("{}: mixes element orders: mesh it again with one order", body.mesh.filename().string()));
}

InputError foreign_nodes(const scene::Body& body) {
  return InputError(
      fmt::format("{}: bodies.{}.contact has nodes that are not the body's: mesh surface and volume together",
                  body.mesh.filename().string(), body.name));
}

}  // namespace ricochet::mesh
