// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/msh_outline.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <utility>

#include "src/mesh/msh_sections.hpp"

namespace ricochet::mesh {

namespace {

class OutlineReader : public MshSections {
 public:
  using MshSections::MshSections;

  MshOutline outline() {
    read();
    out_.binary = binary_;
    out_.entities.group_name = std::move(names_);
    return std::move(out_);
  }

 private:
  bool section(const std::string& name) override {
    in_.set_binary(binary_);
    if (name == "$Nodes")
      nodes();
    else if (name == "$Elements")
      elements();
    else if (name == "$Periodic")
      periodic();
    else if (name == "$Entities")
      entities(false);
    else if (name == "$PartitionedEntities")
      entities(true);
    else
      return false;
    return true;
  }

  MshList list(std::int64_t records, std::int64_t words, const char* what) {
    MshList list{records, words, {in_.place()}};
    const std::int64_t step = binary_ ? records : MshList::stride;
    for (std::int64_t left = records; left > 0; left -= step) {
      in_.skip(std::min(left, step) * words, what);
      if (left > step) list.at.push_back(in_.place());
    }
    return list;
  }

  std::vector<int> group_numbers() {
    std::vector<int> groups;
    const std::int64_t n = count("the number of groups");
    for (std::int64_t i = 0; i < n; ++i)
      groups.push_back(std::abs(number("a group's number", -largest_int, largest_int)));
    return groups;
  }

  void entities(bool partitioned) {
    if (partitioned) {
      parts_ = count("the number of partitions");
      if (count("the number of ghost entities") != 0) in_.fail("has ghost cells: save the mesh without them");
    }
    std::array<std::int64_t, 4> counts{};
    for (std::int64_t& n : counts) n = count("the number of entities");
    for (int dim = 0; dim < 4; ++dim)
      for (std::int64_t i = 0; i < counts[static_cast<std::size_t>(dim)]; ++i) {
        const EntityKey key{dim, entity("an entity's tag")};
        if (all().contains(key)) in_.fail("an entity occurs twice");
        Entity one;
        if (partitioned) one.parent = parent_of_part(dim);
        for (int c = 0; c < (dim == 0 ? 3 : 6); ++c) in_.real("a corner of an entity's box");
        one.groups = group_numbers();
        if (dim > 0) boundary(dim, partitioned);
        all().emplace(key, std::move(one));
      }
  }

  EntityKey parent_of_part(int dim) {
    const int above = number("the dimension of a partition's parent", 0, 3);
    const EntityKey parent{above, entity("a partition's parent")};
    if (above < dim || !all().contains(parent)) in_.fail("a partition has no parent");
    const std::int64_t n = count("the number of partitions");
    for (std::int64_t i = 0; i < n; ++i)
      out_.last_part = std::max<std::int64_t>(out_.last_part, number("a partition", 1, parts_));
    return parent;
  }

  /// Checks bounding entities. Those of a partition may be in the file of another partition.
  void boundary(int dim, bool partitioned) {
    const std::int64_t n = count("the number of bounding entities");
    for (std::int64_t i = 0; i < n; ++i)
      if (const int other = number("a bounding entity", -largest_int, largest_int);
          !partitioned && !all().contains({dim - 1, std::abs(other)}))
        in_.fail(fmt::format("an entity is bounded by {}, which does not exist", other));
  }

  void nodes() {
    const std::int64_t blocks = count("the number of blocks"), total = count("the number of nodes");
    const std::int64_t low = count("the lowest tag"), high = count("the highest tag");
    std::int64_t counted = 0;
    for (std::int64_t b = 0; b < blocks; ++b) {
      const int dim = number("a dimension", 0, 3);
      entity("an entity's tag");
      const int parameters = number("whether nodes have parameters", 0, 1) == 1 && dim < 3 ? dim : 0;
      const std::int64_t n = count("the number of nodes");
      counted += n;
      if (counted > total) break;
      MshNodes& block = out_.nodes.emplace_back();
      block.lowest = low;
      block.highest = high;
      block.tags = list(n, 1, "a node's tag");
      block.positions = list(n, 3 + parameters, "a coordinate");
    }
    if (counted != total) in_.fail("the number of nodes differs from that of the blocks");
  }

  void elements() {
    const std::int64_t blocks = count("the number of blocks"), total = count("the number of elements");
    count("the lowest tag");
    count("the highest tag");
    std::int64_t counted = 0;
    for (std::int64_t b = 0; b < blocks; ++b) {
      const int dim = number("a dimension", 0, 3);
      const EntityKey key{dim, entity("an entity's tag")};
      const int gmsh_type = number("an element's type", 1, largest_int);
      const ElementType type = type_of(gmsh_type);
      if (type.dim != dim) in_.fail("elements and their entity differ in dimension");
      const std::int64_t n = count("the number of elements");
      counted += n;
      if (counted > total) break;
      all().try_emplace(key);  // files without $Entities
      out_.elements.push_back({key, gmsh_type, list(n, 1 + type.nodes, "a node of an element")});
    }
    if (counted != total) in_.fail("the number of elements differs from that of the blocks");
  }

  void periodic() {
    const std::int64_t links = count("the number of links");
    for (std::int64_t l = 0; l < links; ++l) {
      number("a dimension", 0, 2);
      entity("an entity's tag");
      entity("an entity's tag");
      const std::int64_t affine = count("the size of a transformation");
      if (affine != 0 && affine != 16) in_.fail("a transformation must have 0 or 16 numbers");
      for (std::int64_t i = 0; i < affine; ++i) in_.real("a transformation");
      const std::int64_t pairs = count("the number of pairs");
      out_.periodic.push_back(list(pairs, 2, "a periodic node"));
    }
  }

  std::map<EntityKey, Entity>& all() { return out_.entities.all; }

  MshOutline out_;
  std::int64_t parts_ = 0;
};

}  // namespace

MshOutline outline_of(const std::filesystem::path& msh) { return OutlineReader(msh).outline(); }

}  // namespace ricochet::mesh
