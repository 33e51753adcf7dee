// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/msh_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "src/mesh/msh_outline.hpp"
#include "src/mesh/msh_sections.hpp"

namespace ricochet::mesh {

namespace {

/// The tags of the nodes of a file.
class KnownNodes {
 public:
  explicit KnownNodes(MshStream& in) : in_(in) {}
  void add(std::int64_t node) { tags_.push_back(node); }

  void end() {
    std::sort(tags_.begin(), tags_.end());
    const auto twice = std::adjacent_find(tags_.begin(), tags_.end());
    if (twice != tags_.end()) in_.fail(fmt::format("node {} occurs twice", *twice));
  }

  void refuse_others(std::int64_t node, const char* user) const {
    if (!contains(node)) in_.fail(fmt::format("{} has node {}, which does not exist", user, node));
  }

 private:
  bool contains(std::int64_t node) const {
    if (tags_.empty() || node < tags_.front() || node > tags_.back()) return false;
    if (tags_.back() - tags_.front() + 1 == static_cast<std::int64_t>(tags_.size())) return true;
    return std::binary_search(tags_.begin(), tags_.end(), node);
  }

  MshStream& in_;
  std::vector<std::int64_t> tags_;
};

/// Reads all lists of a file of version 4.1.
void check_lists(const std::filesystem::path& msh, const MshOutline& outline) {
  MshStream in(msh);
  KnownNodes known(in);
  const auto nothing = [](auto...) {};
  for (const MshNodes& block : outline.nodes)
    read_nodes(
        in, outline.binary, block, 0, block.tags.count, [&](std::int64_t tag) { known.add(tag); }, nothing);
  known.end();
  for (const MshElements& block : outline.elements)
    read_elements(in, outline.binary, block.list, 0, block.list.count, nothing,
                  [&](std::int64_t node) { known.refuse_others(node, "an element"); });
  for (const MshList& pairs : outline.periodic)
    read_elements(
        in, outline.binary, pairs, 0, pairs.count,
        [&](std::int64_t node) { known.refuse_others(node, "a pair of periodic nodes"); },
        [&](std::int64_t node) { known.refuse_others(node, "a pair of periodic nodes"); });
}

/// Reads a file of version 2 to 2.2.
class OldCheck : public MshSections {
 public:
  using MshSections::MshSections;

 private:
  bool section(const std::string& name) override {
    if (name == "$Nodes")
      nodes();
    else if (name == "$Elements")
      elements();
    else if (name == "$Periodic")
      periodic();
    else
      return false;
    return true;
  }

  /// Skips to the numbers after a count, which is text even in binary files.
  void skip_to_numbers() {
    if (!binary_) return;
    in_.skip_line();
    in_.set_binary(true);
  }

  void nodes() {
    const std::int64_t n = line_count("the number of nodes");
    skip_to_numbers();
    for (std::int64_t i = 0; i < n; ++i) {
      known_.add(number("a node's number", 1, largest_int));
      coordinates();
    }
    known_.end();
  }

  /// Checks the tags of one element.
  /// @param n         number of its tags
  /// @param elements  number of elements in the file
  void tags(int n, std::int64_t elements) {
    for (int i = 0; i < n; ++i) {
      const int value = number("an element's group", -largest_int, largest_int);
      if (i == 1 && value < 0) in_.fail("an element's entity is negative");
      if (i == 2 && n > 3 && value != n - 3) in_.fail("an element has parts that do not agree, or a parent");
      // gmsh allocates a list as long as the largest partition number.
      if (i == 3 && (value < 1 || value > elements))
        in_.fail("an element's partition is not from 1 to the number of elements");
      if (i > 3) in_.fail("has ghost cells: save the mesh without them");
    }
  }

  void elements() {
    const std::int64_t n = line_count("the number of elements");
    skip_to_numbers();
    for (std::int64_t counted = 0; counted < n;) {
      int type = 0, in_block = 1;
      if (binary_) {
        type = number("an element's type", 1, largest_int);
        in_block = number("the number of elements", 1, n - counted);
      } else {
        number("an element's number", 1, largest_int);
        type = number("an element's type", 1, largest_int);
      }
      const int of_each = number("the number of tags", 0, 1000), nodes = type_of(type).nodes;
      for (int i = 0; i < in_block; ++i) {
        if (binary_) number("an element's number", 1, largest_int);
        tags(of_each, n);
        for (int k = 0; k < nodes; ++k)
          known_.refuse_others(in_.integer<std::int32_t>("a node of an element", 1, largest_tag),
                               "an element");
      }
      counted += in_block;
    }
  }

  void periodic() {
    const std::int64_t links = line_count("the number of links");
    for (std::int64_t l = 0; l < links; ++l) {
      number("a dimension", 0, 2);
      entity("an entity's tag");
      entity("an entity's tag");
      if (!in_.rest_of_line().empty()) in_.fail("a link must be on a line of its own");
      std::string next(in_.word("the number of pairs"));
      if (next == "Affine") {
        for (int i = 0; i < 16; ++i) in_.real("a transformation");
        next = in_.word("the number of pairs");
      }
      // gmsh reads this word into a buffer of six bytes.
      if (next.empty() || next.size() > 5 || next.find_first_not_of("0123456789") != std::string::npos)
        in_.fail("the number of pairs must be below 100000: save the mesh in version 4.1");
      for (std::int64_t i = 0; i < 2 * std::stoll(next); ++i)
        known_.refuse_others(in_.integer<std::uint64_t>("a periodic node", 1, largest_tag),
                             "a pair of periodic nodes");
    }
  }

  KnownNodes known_{in_};
};

}  // namespace

void check_msh(const std::filesystem::path& msh) {
  if (is_old_version(msh_version(msh)))
    OldCheck(msh).read();
  else
    check_lists(msh, outline_of(msh));
}

}  // namespace ricochet::mesh
