// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/share.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "src/mesh/complaints.hpp"
#include "src/mesh/directory.hpp"
#include "src/mesh/read.hpp"
#include "src/scene/parts.hpp"

namespace ricochet::mesh {

namespace {

using parallel::agree;

/// A group that the scene names. Lists of groups have the order of Part::groups.
struct NamedGroup {
  std::string name, key;
  int dim = 0;
  bool support = false;
  bool whole_boundary = false;  ///< without this group, the contact surface is the whole boundary
};

std::vector<NamedGroup> named_groups(const scene::Body& body, const RequestedGroups& wanted) {
  const std::string start = "bodies." + body.name + '.';
  std::vector<NamedGroup> asked;
  for (const scene::Material& material : body.materials)
    if (!material.group.empty()) asked.push_back({material.group, start + "material", 3});
  for (const std::string& name : body.contact)
    asked.push_back({name, start + "contact", 2, false, name == whole_boundary});
  for (const std::string& name : wanted.loaded) asked.push_back({name, traction_key, 2});
  for (const auto& [name, components] : body.support) asked.push_back({name, start + "support", 2, true});
  return asked;
}

InputError misfit(const scene::Body& body, const std::string& what) {
  return InputError(
      fmt::format("{}: its parts do not fit together: {}: split the mesh again, without ghost cells",
                  body.mesh.filename().string(), what));
}

template <class T>
void append(std::vector<T>& all, const std::vector<T>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

void append(std::vector<Block>& blocks, const std::vector<Block>& more) {
  for (const Block& block : more) {
    const auto same = std::ranges::find(blocks, block.gmsh_type, &Block::gmsh_type);
    if (same == blocks.end()) {
      blocks.push_back(block);
      continue;
    }
    append(same->node, block.node);
    append(same->tag, block.tag);
    append(same->label, block.label);
  }
}

/// Adds a part to a share. Nodes of the share may repeat and are still identified by tags.
void append(Part& share, Part part, const scene::Body& body) {
  if (share.order != 0 && part.order != 0 && share.order != part.order) throw mixed_orders(body);
  share.order = std::max(share.order, part.order);
  append(share.tag, part.tag);
  append(share.position, part.position);
  append(share.fixed, part.fixed);
  append(share.blocks, part.blocks);
  append(share.contact, part.contact);
  append(share.loaded, part.loaded);
  for (auto& [corners, nodes] : part.outside) add_face(share.outside, corners, std::move(nodes));
  for (std::size_t g = 0; g < part.groups.size(); ++g) {
    GroupUse &all = share.groups[g], &one = part.groups[g];
    for (std::size_t dim = 0; dim < all.found.size(); ++dim) all.found[dim] |= one.found[dim];
    all.holds |= one.holds;
    append(all.choice.groups, one.choice.groups);
    append(all.choice.entities, one.choice.entities);
  }
}

InputError apart(const scene::Body& body, std::int64_t tag) {
  return misfit(body, fmt::format("node {} lies in different places", tag));
}

InputError repeated(const scene::Body& body, std::int64_t tag) {
  return misfit(body, fmt::format("element {} is in more than one", tag));
}

/// Removes duplicate nodes, sorts nodes by tag, and converts the nodes of blocks to indices.
void merge_nodes(Part& share, const scene::Body& body) {
  std::vector<std::size_t> order(share.tag.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return share.tag[a] < share.tag[b]; });
  std::vector<std::int64_t> tag, fixed;
  std::vector<double> position;
  for (std::size_t n : order) {
    const double* at = &share.position[3 * n];
    if (tag.empty() || tag.back() != share.tag[n]) {
      tag.push_back(share.tag[n]);
      fixed.push_back(share.fixed[n]);
      position.insert(position.end(), at, at + 3);
      continue;
    }
    fixed.back() |= share.fixed[n];
    if (!std::equal(at, at + 3, position.end() - 3)) throw apart(body, tag.back());
  }
  share.tag = std::move(tag);
  share.fixed = std::move(fixed);
  share.position = std::move(position);
  for (Block& block : share.blocks)
    for (std::int64_t& node : block.node)
      node = std::lower_bound(share.tag.begin(), share.tag.end(), node) - share.tag.begin();
}

std::vector<std::int64_t> element_tags(const Part& share) {
  std::vector<std::int64_t> tags;
  for (const Block& block : share.blocks) append(tags, block.tag);
  std::sort(tags.begin(), tags.end());
  return tags;
}

/// Collects the distinct names of all ranks on rank 0. Collective.
std::vector<std::string> gather_names(MPI_Comm comm, const std::vector<std::string>& mine) {
  std::vector<char> text;
  for (const std::string& name : mine) {
    text.insert(text.end(), name.begin(), name.end());
    text.push_back('\0');
  }
  text = parallel::gather(comm, text);
  std::vector<std::string> names;
  for (auto at = text.begin(); at != text.end();) {
    const auto end = std::find(at, text.end(), '\0');
    names.emplace_back(at, end);
    at = end + 1;
  }
  // Entities are sorted by number: "surface 9" precedes "surface 10".
  std::sort(names.begin(), names.end());
  std::stable_sort(names.begin(), names.end(), [](const auto& a, const auto& b) {
    return a.find(' ') != std::string::npos && a.size() < b.size();
  });
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

/// Checks each group of the scene: some part must contain it, all parts must agree on its dimension, and a
/// support must contain nodes of the body. Throws on every rank otherwise. Collective.
/// @return whether the contact surface is the whole boundary
bool check_groups(const scene::Body& body, const std::vector<NamedGroup>& asked,
                  const std::vector<GroupUse>& uses, MPI_Comm comm) {
  constexpr std::size_t dims = 4;
  // Per group: number of ranks that found it, for each dimension, then number of ranks on which it has nodes.
  std::vector<double> parts;
  for (const GroupUse& use : uses) {
    for (bool found : use.found) parts.push_back(found ? 1 : 0);
    parts.push_back(use.holds ? 1 : 0);
  }
  parallel::sum(comm, parts);
  bool touches_everywhere = false;
  for (std::size_t g = 0; g < asked.size(); ++g) {
    const auto found = parts.begin() + static_cast<std::ptrdiff_t>(g * (dims + 1));
    const auto kinds = std::count_if(found, found + dims, [](double ranks) { return ranks > 0; });
    if (kinds == 0 && asked[g].whole_boundary) {
      refuse_more_than_all(body);
      touches_everywhere = true;
      continue;
    }
    if (kinds == 0) {
      const Choice choice{gather_names(comm, uses[g].choice.groups),
                          gather_names(comm, uses[g].choice.entities)};
      parallel::on_first_rank(comm, [&] {
        throw no_group(asked[g].dim, asked[g].name, choice, body.mesh.filename().string(), asked[g].key);
      });
    }
    // In an unpartitioned mesh, the group of the highest dimension would be used, but a part may not contain
    // it.
    if (kinds > 1)
      throw InputError(
          fmt::format("{}: \"{}\" names groups of two dimensions, of which parts have one or the other: give "
                      "them different names, or change {}",
                      body.mesh.filename().string(), asked[g].name, asked[g].key));
    if (asked[g].support && found[dims] == 0) throw holds_nothing(body, asked[g].name);
  }
  return touches_everywhere;
}

/// The facets of all faces on the outside of a share, with nodes identified by tags.
std::vector<Block> boundary_of(const Part& share) {
  Faces outside;
  for (const auto& [key, value] : share.outside) {
    Corners corners = key;
    FaceNodes nodes = value;
    for (Corners* tags : {&corners, &nodes})
      for (std::int64_t& tag : *tags) tag = std::ranges::lower_bound(share.tag, tag) - share.tag.begin();
    add_face(outside, std::move(corners), std::move(nodes));
  }
  std::vector<Block> boundary = boundary_of(share.blocks, outside);
  for (Block& block : boundary)
    for (std::int64_t& node : block.node) node = share.tag[static_cast<std::size_t>(node)];
  return boundary;
}

/// Checks that all ranks have the same element order, have no element in common, and agree on the positions
/// of shared nodes. Throws on every rank otherwise. Collective.
void check_fit(const scene::Body& body, const Part& share, MPI_Comm comm) {
  std::string complaint;
  const auto lower = [](auto a, auto b) { return std::min(a, b); };
  const double order = parallel::largest(comm, share.order);
  if (order == 0) throw no_elements(body);
  if (share.order != 0 && share.order != order) complaint = mixed_orders(body).what();
  agree(comm, complaint);

  const std::vector<std::int64_t> tags = element_tags(share);
  const std::int64_t me = parallel::rank_of(comm);
  const std::vector<std::int64_t> reader =
      Directory(comm, tags).combined(std::vector<std::int64_t>(tags.size(), me), lower);
  for (std::size_t e = 0; e < tags.size() && complaint.empty(); ++e)
    if (reader[e] != me) complaint = repeated(body, tags[e]).what();

  const Directory nodes(comm, share.tag);
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<double> x;
    for (std::size_t n = 0; n < share.tag.size(); ++n) x.push_back(share.position[3 * n + c]);
    const std::vector<double> lowest = nodes.combined(x, lower);
    for (std::size_t n = 0; n < x.size() && complaint.empty(); ++n)
      if (lowest[n] != x[n]) complaint = apart(body, share.tag[n]).what();
  }
  agree(comm, complaint);
}

}  // namespace

Part read_share(const scene::Body& body, const RequestedGroups& wanted, MPI_Comm comm,
                const parallel::Progress& progress) {
  const std::vector<NamedGroup> groups = named_groups(body, wanted);
  Part share;
  share.groups.resize(groups.size());
  parallel::on_all_ranks(comm, [&] {
    const std::vector<std::filesystem::path> files = scene::part_files(body.mesh);
    const auto ranks = static_cast<std::size_t>(parallel::size_of(comm)),
               me = static_cast<std::size_t>(parallel::rank_of(comm));
    const std::size_t first = files.size() * me / ranks, last = files.size() * (me + 1) / ranks;
    scene::Body one = body;
    for (std::size_t part = first; part < last; ++part) {
      one.mesh = files[part];
      append(share, read_part(one, static_cast<int>(files.size()), wanted), body);
      if (progress)
        progress(static_cast<std::int64_t>(part + 1 - first), static_cast<std::int64_t>(last - first));
    }
    merge_nodes(share, body);
    const std::vector<std::int64_t> tags = element_tags(share);
    if (const auto twice = std::adjacent_find(tags.begin(), tags.end()); twice != tags.end())
      throw repeated(body, *twice);
  });
  share.touches_everywhere = check_groups(body, groups, share.groups, comm);
  check_fit(body, share, comm);
  if (share.touches_everywhere) share.contact = boundary_of(share);
  return share;
}

}  // namespace ricochet::mesh
