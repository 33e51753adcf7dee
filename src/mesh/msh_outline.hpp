// SPDX-License-Identifier: BSD-2-Clause
// Internal to src/mesh: where the nodes and elements of a .msh file of version 4.1 are, so that each rank can
// read a range of them.
#pragma once

#include <algorithm>
#include <filesystem>
#include <vector>

#include "src/mesh/groups.hpp"
#include "src/mesh/msh_stream.hpp"

namespace ricochet::mesh {

/// Records of equal length, such as the elements of a block. A record consists of `words` numbers of eight
/// bytes in a binary file, and of `words` words in a text.
struct MshList {
  std::int64_t count = 0, words = 0;
  std::vector<Place> at;  ///< of each record k · `stride`; in binary files, of the first one
  static constexpr std::int64_t stride = 1024;
};

struct MshNodes {
  MshList tags, positions;
  std::int64_t lowest = 1, highest = 0;  ///< permitted tags
};

struct MshElements {
  EntityKey entity;
  int gmsh_type = 0;
  MshList list;  ///< tag and nodes
};

/// All of a file but the numbers in its lists.
struct MshOutline {
  bool binary = false;
  Entities entities;
  std::vector<MshNodes> nodes;
  std::vector<MshElements> elements;
  std::vector<MshList> periodic;  ///< pairs of nodes
  std::int64_t last_part = 0;     ///< largest number of a part that the file names
};

/// Reads the headers of a file. Those of a binary file are found by their places, those of a text by counting
/// words. Refuses what cannot be a mesh: versions other than 4.1, sections of results, ghost cells or
/// parametrisations, counts that disagree, elements of unknown type. The lists are not read.
/// Needs a GmshSession. Throws InputError "FILE: line N: what".
MshOutline outline_of(const std::filesystem::path& msh);

/// Calls take(in) for each of the records [first, last) of a list, with `in` at the record.
template <class Take>
void for_each_record(MshStream& in, bool binary, const MshList& list, std::int64_t first, std::int64_t last,
                     const Take& take) {
  const std::int64_t mark = binary ? 0 : first / MshList::stride;
  in.go_to(list.at[static_cast<std::size_t>(mark)]);
  in.set_binary(binary);
  in.skip((first - mark * MshList::stride) * list.words, "a number");
  for (std::int64_t i = first; i < last; ++i) take(in);
}

/// Reads the tags and the positions of nodes [first, last) of a block. Calls tag(number) for each node, then
/// place(x, y, z) for each.
template <class Tag, class At>
void read_nodes(MshStream& in, bool binary, const MshNodes& nodes, std::int64_t first, std::int64_t last,
                const Tag& tag, const At& place) {
  for_each_record(in, binary, nodes.tags, first, last, [&](MshStream& at) {
    tag(at.integer<std::uint64_t>("a node's tag", std::max<std::int64_t>(nodes.lowest, 1), nodes.highest));
  });
  for_each_record(in, binary, nodes.positions, first, last, [&](MshStream& at) {
    const double x = at.real("a coordinate"), y = at.real("a coordinate"), z = at.real("a coordinate");
    for (std::int64_t k = 3; k < nodes.positions.words; ++k) at.real("a parameter");
    place(x, y, z);
  });
}

/// Reads elements [first, last) of a block. Calls element(tag), then node(tag) for each of its nodes.
template <class Element, class Node>
void read_elements(MshStream& in, bool binary, const MshList& list, std::int64_t first, std::int64_t last,
                   const Element& element, const Node& node) {
  constexpr std::int64_t largest_tag = std::int64_t{1} << 40;
  for_each_record(in, binary, list, first, last, [&](MshStream& at) {
    element(at.integer<std::uint64_t>("an element's tag", 1, largest_tag));
    for (std::int64_t k = 1; k < list.words; ++k)
      node(at.integer<std::uint64_t>("a node of an element", 1, largest_tag));
  });
}

}  // namespace ricochet::mesh
