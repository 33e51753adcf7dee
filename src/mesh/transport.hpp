// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/mesh: the bytes in which two processes of one build exchange bodies and meshes.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "src/mesh/mesh.hpp"
#include "src/mesh/msh_outline.hpp"
#include "src/mesh/open.hpp"
#include "src/mesh/triangulate.hpp"

namespace ricochet::mesh {

/// Appends values to `bytes`.
class Packer {
 public:
  std::string bytes;
  void raw(void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); }
  std::size_t size(std::size_t count) {
    auto stored = static_cast<std::uint64_t>(count);
    raw(&stored, sizeof stored);
    return count;
  }
};

/// Takes values from `bytes` in the same order. Throws std::runtime_error at their end.
class Unpacker {
 public:
  explicit Unpacker(const std::string& bytes) : bytes_(bytes) {}
  void raw(void* data, std::size_t size) {
    if (size > bytes_.size() - at_) throw std::runtime_error("the answer of ricochet-mesh is incomplete");
    if (size > 0) std::memcpy(data, bytes_.data() + at_, size);
    at_ += size;
  }
  std::size_t size(std::size_t) {
    std::uint64_t stored = 0;
    raw(&stored, sizeof stored);
    if (stored > bytes_.size()) throw std::runtime_error("the answer of ricochet-mesh is incomplete");
    return static_cast<std::size_t>(stored);
  }

 private:
  const std::string& bytes_;
  std::size_t at_ = 0;
};

/// Packs or unpacks values. What has the same layout in both processes is copied.
template <class Stream, class T>
requires std::is_trivially_copyable_v<T>
void pass(Stream& stream, T& value) { stream.raw(&value, sizeof value); }

template <class Stream>
void pass(Stream& stream, std::string& text) {
  text.resize(stream.size(text.size()));
  stream.raw(text.data(), text.size());
}

template <class Stream>
void pass(Stream& stream, std::filesystem::path& path) {
  std::string text = path.string();
  pass(stream, text);
  path = text;
}

template <class Stream, class T>
void pass(Stream& stream, std::vector<T>& list) {
  list.resize(stream.size(list.size()));
  if constexpr (std::is_trivially_copyable_v<T>)
    stream.raw(list.data(), list.size() * sizeof(T));
  else
    for (T& one : list) pass(stream, one);
}

template <class Stream, class Key, class Value>
void pass(Stream& stream, std::map<Key, Value>& map) {
  std::vector<Key> keys;
  for (const auto& [key, value] : map) keys.push_back(key);
  pass(stream, keys);
  for (const Key& key : keys) pass(stream, map[key]);
}

template <class Stream, class... Values>
void pass_all(Stream& stream, Values&... values) {
  (pass(stream, values), ...);
}

template <class Stream>
void pass(Stream& stream, scene::Material& material) {
  pass_all(stream, material.group, material.density, material.young, material.poisson, material.area,
           material.yield, material.orthotropy, material.stiffness, material.axes, material.about);
}

/// What a mesh depends on, and what messages name.
template <class Stream>
void pass(Stream& stream, scene::Body& body) {
  pass_all(stream, body.name, body.mesh, body.geometry, body.order, body.size_factor, body.refine, body.scale,
           body.materials, body.contact, body.support);
}

template <class Stream>
void pass(Stream& stream, RequestedGroups& asked) {
  pass_all(stream, asked.loaded, asked.moved);
}

template <class Stream>
void pass(Stream& stream, Block& block) {
  pass_all(stream, block.gmsh_type, block.nodes_per_element, block.node, block.tag, block.label);
}

template <class Stream>
void pass(Stream& stream, FacetMesh& facets) {
  pass_all(stream, facets.node, facets.position, facets.blocks, facets.end_normal);
}

template <class Stream>
void pass(Stream& stream, GlobalMesh& mesh) {
  pass_all(stream, mesh.dim, mesh.order, mesh.position, mesh.blocks, mesh.fixed, mesh.axis, mesh.contact,
           mesh.loaded, mesh.visualisation, mesh.warnings);
}

template <class Stream>
void pass(Stream& stream, Entity& entity) {
  pass_all(stream, entity.groups, entity.parent);
}

template <class Stream>
void pass(Stream& stream, MshList& list) {
  pass_all(stream, list.count, list.words, list.at);
}

template <class Stream>
void pass(Stream& stream, MshNodes& nodes) {
  pass_all(stream, nodes.tags, nodes.positions, nodes.lowest, nodes.highest);
}

template <class Stream>
void pass(Stream& stream, MshElements& elements) {
  pass_all(stream, elements.entity, elements.gmsh_type, elements.list);
}

template <class Stream>
void pass(Stream& stream, MshOutline& outline) {
  pass_all(stream, outline.binary, outline.entities.all, outline.entities.group_name, outline.nodes,
           outline.elements, outline.last_part);
}

template <class Stream>
void pass(Stream& stream, Triangulation& triangles) {
  pass_all(stream, triangles.position, triangles.triangle, triangles.exact, triangles.sewn);
}

}  // namespace ricochet::mesh
