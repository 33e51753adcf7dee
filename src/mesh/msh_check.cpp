// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/msh_check.hpp"

#include <fmt/format.h>
#include <gmsh.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "ricochet/error.hpp"
#include "src/mesh/msh_stream.hpp"

namespace ricochet::mesh {

namespace {

constexpr std::int64_t largest_int = 2147483647, largest_tag = std::int64_t{1} << 40;

struct ElementType {
  int dim = 0, nodes = 0;
};

/// Element types with Lagrange nodes, either all of them or only those on edges.
const std::map<int, ElementType>& element_types() {
  static const auto all = [] {
    std::map<int, ElementType> types{{15, {0, 1}}};
    for (int p = 1; p <= 10; ++p) {
      struct Kind {
        const char* family;
        int dim, largest_order, complete, on_edges;
      };
      const int inner = p - 1;
      for (const auto& [family, dim, largest_order, complete, on_edges] :
           {Kind{"line", 1, 10, p + 1, p + 1}, Kind{"triangle", 2, 10, (p + 1) * (p + 2) / 2, 3 * p},
            Kind{"quadrangle", 2, 10, (p + 1) * (p + 1), 4 * p},
            Kind{"tetrahedron", 3, 10, (p + 1) * (p + 2) * (p + 3) / 6, 4 + 6 * inner},
            Kind{"hexahedron", 3, 9, (p + 1) * (p + 1) * (p + 1), 8 + 12 * inner},
            Kind{"prism", 3, 9, (p + 1) * (p + 1) * (p + 2) / 2, 6 + 9 * inner},
            Kind{"pyramid", 3, 9, (p + 1) * (p + 2) * (2 * p + 3) / 6, 5 + 8 * inner}}) {
        if (p > largest_order) continue;
        types[gmsh::model::mesh::getElementType(family, p, /*serendip=*/true)] = {dim, on_edges};
        types[gmsh::model::mesh::getElementType(family, p)] = {dim, complete};
      }
    }
    return types;
  }();
  return all;
}

class Check {
 public:
  explicit Check(const std::filesystem::path& msh) : in_(msh) {}

  void start() {
    if (in_.ended() || in_.word("$MeshFormat") != "$MeshFormat")
      in_.fail(
          "is not a gmsh mesh (it does not start with $MeshFormat): write it with gmsh, or name another "
          "file");
  }

  void sections() {
    format();
    while (!in_.ended()) {
      const std::string name(in_.word("a section"));
      if (!in_.rest_of_line().empty()) in_.fail("the name of a section must be on a line of its own");
      if (name != "$Comments" && !seen_.insert(name).second) in_.fail("the second section of its kind");
      section(name);
    }
    for (const char* needed : {"$Nodes", "$Elements"})
      if (seen_.count(needed) == 0) in_.fail(fmt::format("has no {}: write it again with gmsh", needed));
  }

 private:
  using Key = std::pair<int, int>;

  void format() {
    const std::string version(in_.word("the version"));
    old_ = version == "2" || version == "2.0" || version == "2.1" || version == "2.2";
    if (!old_ && version != "4.1")
      in_.fail("has an unsupported version: write it in version 4.1 or 2.2 (Mesh.MshFileVersion)");
    binary_ = in_.integer<std::int32_t>("the kind of file", 0, 1) == 1;
    in_.integer<std::int32_t>("the size of numbers", 8, 8);
    in_.rest_of_line();
    if (binary_) {
      in_.skip_line();
      in_.set_binary(true);
      if (in_.integer<std::int32_t>("1", -largest_int, largest_int) != 1)
        in_.fail("its numbers have the wrong byte order, or are text: write it on this machine, or as text");
    }
    end("$EndMeshFormat");
  }

  void end(const std::string& name) {
    in_.set_binary(false);
    if (in_.word(name.c_str()) != name) in_.fail(fmt::format("{} is not where the counts place it", name));
  }

  void section(const std::string& name) {
    if (name == "$Comments") return comments();
    if (name == "$PhysicalNames") {
      names();
    } else {
      in_.skip_line();
      if (name == "$Nodes")
        old_ ? old_nodes() : nodes();
      else if (name == "$Elements")
        old_ ? old_elements() : elements();
      else if (name == "$Periodic")
        old_ ? old_periodic() : periodic();
      else if (!old_ && name == "$Entities")
        entities(false);
      else if (!old_ && name == "$PartitionedEntities")
        entities(true);
      else
        in_.fail("contains an unsupported section: save the mesh alone, without results and ghost cells");
    }
    end("$End" + name.substr(1));
  }

  void comments() {
    while (in_.rest_of_line() != "$EndComments") {
      in_.skip_line();
      if (in_.ended()) in_.fail("is cut off: $EndComments is missing");
    }
  }

  /// These functions read integers of the types that the format prescribes.
  std::int64_t count(const char* what) { return in_.integer<std::uint64_t>(what, 0, largest_tag); }
  std::int64_t tag(const char* what) { return in_.integer<std::uint64_t>(what, 1, largest_tag); }
  int number(const char* what, std::int64_t low, std::int64_t high) {
    return static_cast<int>(in_.integer<std::int32_t>(what, low, high));
  }
  int entity(const char* what) { return number(what, 0, largest_int); }

  /// Reads a count that stands on a line of its own.
  std::int64_t line_count(const char* what) {
    const std::int64_t n = in_.integer<std::int32_t>(what, 0, largest_int);
    if (!in_.rest_of_line().empty()) in_.fail(fmt::format("{} must be on a line of its own", what));
    return n;
  }

  void names() {
    in_.skip_line();
    const std::int64_t n = line_count("the number of names");
    for (std::int64_t i = 0; i < n; ++i) {
      number("a group's dimension", 0, 3);
      number("a group's number", 1, largest_int);
      const std::string name = in_.rest_of_line();
      if (name.size() < 2 || name.size() > 130 || name.front() != '"' || name.find('"', 1) != name.size() - 1)
        in_.fail("the name of a group must be in quotes and have at most 128 bytes");
    }
  }

  void coordinates() {
    for (int c = 0; c < 3; ++c) in_.real("a coordinate");
  }

  void group_numbers() {
    const std::int64_t n = count("the number of groups");
    for (std::int64_t i = 0; i < n; ++i) number("a group's number", -largest_int, largest_int);
  }

  void entities(bool partitioned) {
    in_.set_binary(binary_);
    if (partitioned) {
      partitions_ = count("the number of partitions");
      if (count("the number of ghost entities") != 0) in_.fail("has ghost cells: save the mesh without them");
    }
    std::array<std::int64_t, 4> counts{};
    for (std::int64_t& n : counts) n = count("the number of entities");
    for (int dim = 0; dim < 4; ++dim)
      for (std::int64_t i = 0; i < counts[static_cast<std::size_t>(dim)]; ++i) {
        if (!entities_.insert({dim, entity("an entity's tag")}).second) in_.fail("an entity occurs twice");
        if (partitioned) partition_of(dim);
        for (int c = 0; c < (dim == 0 ? 3 : 6); ++c) in_.real("a corner of an entity's box");
        group_numbers();
        if (dim > 0) boundary(dim, partitioned);
      }
  }

  void partition_of(int dim) {
    const int above = number("the dimension of a partition's parent", 0, 3),
              parent = entity("a partition's parent");
    if (above < dim || entities_.count({above, parent}) == 0) in_.fail("a partition has no parent");
    const std::int64_t n = count("the number of partitions");
    for (std::int64_t i = 0; i < n; ++i) number("a partition", 1, partitions_);
  }

  /// Checks bounding entities. Those of a partition may be in the file of another partition.
  void boundary(int dim, bool partitioned) {
    const std::int64_t n = count("the number of bounding entities");
    for (std::int64_t i = 0; i < n; ++i)
      if (const int other = number("a bounding entity", -largest_int, largest_int);
          !partitioned && entities_.count({dim - 1, std::abs(other)}) == 0)
        in_.fail(fmt::format("an entity is bounded by {}, which does not exist", other));
  }

  void nodes() {
    in_.set_binary(binary_);
    const std::int64_t blocks = count("the number of blocks"), all = count("the number of nodes");
    const std::int64_t low = count("the lowest tag"), high = count("the highest tag");
    for (std::int64_t b = 0; b < blocks; ++b) {
      const int dim = number("a dimension", 0, 3);
      entity("an entity's tag");
      const int parameters = number("whether nodes have parameters", 0, 1) == 1 && dim < 3 ? dim : 0;
      const std::int64_t n = count("the number of nodes");
      for (std::int64_t i = 0; i < n; ++i)
        nodes_.push_back(in_.integer<std::uint64_t>("a node's tag", std::max<std::int64_t>(low, 1), high));
      for (std::int64_t i = 0; i < n; ++i) {
        coordinates();
        for (int c = 0; c < parameters; ++c) in_.real("a parameter");
      }
    }
    if (static_cast<std::int64_t>(nodes_.size()) != all)
      in_.fail("the number of nodes differs from that of the blocks");
    sort_nodes();
  }

  void old_nodes() {
    const std::int64_t n = line_count("the number of nodes");
    skip_to_numbers();
    for (std::int64_t i = 0; i < n; ++i) {
      nodes_.push_back(number("a node's number", 1, largest_int));
      coordinates();
    }
    sort_nodes();
  }

  /// Skips to the numbers after a count, which is text even in binary files.
  void skip_to_numbers() {
    if (!binary_) return;
    in_.skip_line();
    in_.set_binary(true);
  }

  void sort_nodes() {
    std::sort(nodes_.begin(), nodes_.end());
    const auto twice = std::adjacent_find(nodes_.begin(), nodes_.end());
    if (twice != nodes_.end()) in_.fail(fmt::format("node {} occurs twice", *twice));
  }

  bool is_node(std::int64_t node) const {
    if (nodes_.empty() || node < nodes_.front() || node > nodes_.back()) return false;
    if (nodes_.back() - nodes_.front() + 1 == static_cast<std::int64_t>(nodes_.size())) return true;
    return std::binary_search(nodes_.begin(), nodes_.end(), node);
  }

  template <class T>
  void element_node() {
    if (const std::int64_t node = in_.integer<T>("a node of an element", 1, largest_tag); !is_node(node))
      in_.fail(fmt::format("an element has node {}, which does not exist", node));
  }

  ElementType type_of(int type) const {
    const auto found = element_types().find(type);
    if (found == element_types().end())
      in_.fail(fmt::format(
          "elements of type {} are not supported: mesh with tetrahedra, hexahedra, prisms or lines", type));
    return found->second;
  }

  void elements() {
    in_.set_binary(binary_);
    const std::int64_t blocks = count("the number of blocks"), all = count("the number of elements");
    count("the lowest tag");
    count("the highest tag");
    std::int64_t counted = 0;
    for (std::int64_t b = 0; b < blocks; ++b) {
      const int dim = number("a dimension", 0, 3);
      entity("an entity's tag");
      const ElementType type = type_of(number("an element's type", 1, largest_int));
      if (type.dim != dim) in_.fail("elements and their entity differ in dimension");
      const std::int64_t n = count("the number of elements");
      for (std::int64_t i = 0; i < n; ++i) {
        tag("an element's tag");
        for (int k = 0; k < type.nodes; ++k) element_node<std::uint64_t>();
      }
      counted += n;
    }
    if (counted != all) in_.fail("the number of elements differs from that of the blocks");
  }

  /// Checks the tags of one element.
  /// @param n         number of its tags
  /// @param elements  number of elements in the file
  void old_tags(int n, std::int64_t elements) {
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

  void old_elements() {
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
      const int tags = number("the number of tags", 0, 1000), nodes = type_of(type).nodes;
      for (int i = 0; i < in_block; ++i) {
        if (binary_) number("an element's number", 1, largest_int);
        old_tags(tags, n);
        for (int k = 0; k < nodes; ++k) element_node<std::int32_t>();
      }
      counted += in_block;
    }
  }

  void pairs(std::int64_t n) {
    for (std::int64_t i = 0; i < 2 * n; ++i)
      if (!is_node(tag("a periodic node"))) in_.fail("a periodic node does not exist");
  }

  void periodic() {
    in_.set_binary(binary_);
    const std::int64_t links = count("the number of links");
    for (std::int64_t l = 0; l < links; ++l) {
      number("a dimension", 0, 2);
      entity("an entity's tag");
      entity("an entity's tag");
      const std::int64_t affine = count("the size of a transformation");
      if (affine != 0 && affine != 16) in_.fail("a transformation must have 0 or 16 numbers");
      for (std::int64_t i = 0; i < affine; ++i) in_.real("a transformation");
      pairs(count("the number of pairs"));
    }
  }

  void old_periodic() {
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
      pairs(std::stoll(next));
    }
  }

  MshStream in_;
  bool old_ = false, binary_ = false;
  std::int64_t partitions_ = 0;
  std::set<std::string> seen_;
  std::set<Key> entities_;
  std::vector<std::int64_t> nodes_;  ///< tags, ascending
};

/// Refuses files without a closing line; most truncated files lack it.
void refuse_cut_off(const std::filesystem::path& msh) {
  std::ifstream stream(msh, std::ios::binary | std::ios::ate);
  const std::streamoff size = stream.tellg(), length = std::min<std::streamoff>(size, 256);
  std::string tail(static_cast<std::size_t>(std::max<std::streamoff>(length, 0)), ' ');
  stream.seekg(size - length);
  stream.read(tail.data(), length);
  tail.erase(tail.find_last_not_of(" \t\r\n") + 1);
  tail.erase(0, tail.find_last_of('\n') + 1);
  if (!tail.starts_with("$End"))
    throw InputError(fmt::format(
        "{}: is cut off (its last line is not $EndElements or another end): write it again with gmsh",
        msh.filename().string()));
}

}  // namespace

void check_msh(const std::filesystem::path& msh) {
  Check check(msh);
  check.start();
  refuse_cut_off(msh);
  check.sections();
}

}  // namespace ricochet::mesh
