// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/share.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <utility>

#include "src/mesh/complaints.hpp"
#include "src/mesh/directory.hpp"
#include "src/mesh/number.hpp"
#include "src/mesh/split.hpp"
#include "src/mesh/uses.hpp"

namespace ricochet::mesh {

namespace {

using parallel::agree;

/// What one rank has read. Nodes are identified by their tags.
struct Records {
  Numbers node;
  std::vector<double> position;              ///< (n,3) [m], scaled
  std::vector<Block> body, contact, loaded;  ///< of the same types on every rank
  Numbers held, support;                     ///< nodes of supports, and bits as in Uses::support
};

Block& block_in(std::vector<Block>& blocks, const MshElements& elements) {
  auto found = std::ranges::find(blocks, elements.gmsh_type, &Block::gmsh_type);
  if (found == blocks.end())
    found = blocks.insert(found, {elements.gmsh_type, static_cast<int>(elements.list.words) - 1, {}, {}, {}});
  return *found;
}

class RangeReader {
 public:
  RangeReader(const MshFiles& files, const scene::Body& body, const Uses& uses, MPI_Comm comm)
      : files_(files),
        scale_(body.scale),
        uses_(uses),
        ranks_(parallel::size_of(comm)),
        me_(parallel::rank_of(comm)) {}

  Records read() {
    read_range(
        [](const MshOutline& file) -> auto& { return file.nodes; },
        [](const MshNodes& block) { return block.tags.count; },
        [&](const MshNodes& block, std::int64_t first, std::int64_t last) {
          read_nodes(
              *in_, binary_, block, first, last, [&](auto tag) { out_.node.push_back(tag); },
              [&](double x, double y, double z) {
                for (const double at : {x, y, z}) out_.position.push_back(scale_ * at);
              });
        });
    // Volumes and other elements each in equal shares.
    for (const bool of_body : {true, false})
      read_range(
          [](const MshOutline& file) -> auto& { return file.elements; },
          [&](const MshElements& block) {
            return uses_.contains(block.entity) && is_of_body(block) == of_body ? block.list.count : 0;
          },
          [&](const MshElements& block, std::int64_t first, std::int64_t last) {
            read_block(block, first, last);
          });
    return std::move(out_);
  }

 private:
  bool is_of_body(const MshElements& block) const {
    return block.entity.dim == 3 && uses_.material.contains(block.entity.tag);
  }

  /// Reads this rank's equal share of the records of some blocks of all files.
  template <class Blocks, class Count, class Read>
  void read_range(const Blocks& blocks, const Count& count, const Read& read) {
    std::int64_t total = 0, before = 0;
    for (const MshOutline& file : files_.outline)
      for (const auto& block : blocks(file)) total += count(block);
    const std::int64_t first = total * me_ / ranks_, last = total * (me_ + 1) / ranks_;
    for (std::size_t f = 0; f < files_.outline.size(); ++f) {
      in_.reset();
      binary_ = files_.outline[f].binary;
      for (const auto& block : blocks(files_.outline[f])) {
        const std::int64_t records = count(block), begin = std::max(first - before, std::int64_t{0}),
                           end = std::min(last - before, records);
        before += records;
        if (begin >= end) continue;
        if (!in_) in_.emplace(files_.path[f]);
        read(block, begin, end);
      }
    }
  }

  void read_block(const MshElements& block, std::int64_t first, std::int64_t last) {
    std::vector<std::pair<Block*, std::int64_t>> to;
    const auto add = [&](std::vector<Block>& blocks, const Labels& labels) {
      if (const auto found = labels.find(block.entity.tag); found != labels.end())
        for (const std::int64_t label : found->second) to.emplace_back(&block_in(blocks, block), label);
    };
    if (block.entity.dim == 3) add(out_.body, uses_.material);
    if (block.entity.dim == 2) {
      add(out_.contact, uses_.contact);
      add(out_.loaded, uses_.loaded);
    }
    const auto holds = uses_.support.find(block.entity);
    read_elements(
        *in_, binary_, block.list, first, last,
        [&](std::int64_t tag) {
          for (const auto& [one, label] : to) {
            one->tag.push_back(tag);
            one->label.push_back(label);
          }
        },
        [&](std::int64_t node) {
          for (const auto& [one, label] : to) one->node.push_back(node);
          if (holds == uses_.support.end()) return;
          out_.held.push_back(node);
          out_.support.push_back(holds->second);
        });
  }

  const MshFiles& files_;
  double scale_;
  const Uses& uses_;
  std::int64_t ranks_, me_;
  std::optional<MshStream> in_;
  bool binary_ = false;
  Records out_;
};

/// Adds empty blocks, so that every rank has the same types in the same order.
void same_types(const MshFiles& files, const Uses& uses, Records& read) {
  Records all;
  for (const MshOutline& outline : files.outline)
    for (const MshElements& block : outline.elements) {
      if (block.entity.dim == 3 && uses.material.contains(block.entity.tag)) block_in(all.body, block);
      if (block.entity.dim == 2 && uses.contact.contains(block.entity.tag)) block_in(all.contact, block);
      if (block.entity.dim == 2 && uses.loaded.contains(block.entity.tag)) block_in(all.loaded, block);
    }
  for (auto [empty, mine] : {std::pair{&all.body, &read.body}, std::pair{&all.contact, &read.contact},
                             std::pair{&all.loaded, &read.loaded}}) {
    for (Block& block : *empty)
      if (const auto found = std::ranges::find(*mine, block.gmsh_type, &Block::gmsh_type);
          found != mine->end())
        block = std::move(*found);
    *mine = std::move(*empty);
  }
}

std::string about(const scene::Body& body, const std::string& what) {
  return fmt::format("{}: {}", body.mesh.filename().string(), what);
}

/// A fault of one file, or of files that do not fit together.
std::string misfit(const scene::Body& body, bool in_parts, const std::string& one,
                   const std::string& several) {
  return in_parts
             ? about(body, fmt::format("its parts do not fit together: {}: split the mesh again, without "
                                       "ghost cells",
                                       several))
             : about(body, fmt::format("{}: write it again with gmsh", one));
}

/// Refuses elements that occur twice. Collective; throws InputError on every rank.
void refuse_repeated_elements(const std::vector<Block>& blocks, const scene::Body& body, bool in_parts,
                              MPI_Comm comm) {
  Numbers tags;
  for (const Block& block : blocks) tags.insert(tags.end(), block.tag.begin(), block.tag.end());
  std::ranges::sort(tags);
  std::optional<std::int64_t> twice;
  if (const auto found = std::ranges::adjacent_find(tags); found != tags.end()) twice = *found;
  sort_once(tags);
  const std::int64_t me = parallel::rank_of(comm);
  const Numbers reader =
      Directory(comm, tags).combined(Numbers(tags.size(), me), [](auto a, auto b) { return std::min(a, b); });
  for (std::size_t e = 0; e < tags.size() && !twice; ++e)
    if (reader[e] != me) twice = tags[e];
  agree(comm, twice ? misfit(body, in_parts, fmt::format("element {} occurs twice", *twice),
                             fmt::format("element {} is in more than one", *twice))
                    : "");
}

/// The nodes that all ranks have read, by tag. A rank knows those that it has read, and those that its
/// elements use.
class NodeTable {
 public:
  /// Collective; throws InputError on every rank if a node is missing, or defined twice.
  /// @param tags  ascending; contains the nodes that were read
  NodeTable(Numbers tags, const Records& read, const scene::Body& body, bool in_parts, MPI_Comm comm)
      : tags_(std::move(tags)), support_(tags_.size(), 0) {
    const auto sum = [](auto a, auto b) { return a + b; };
    const auto lower = [](auto a, auto b) { return std::min(a, b); };
    const Directory directory(comm, tags_);
    Numbers times(tags_.size(), 0);
    for (const std::int64_t node : read.node) ++times[index(node)];
    times = directory.combined(times, sum);
    std::string complaint;
    const auto complain = [&](const std::string& text) {
      if (complaint.empty()) complaint = text;
    };
    for (std::size_t i = 0; i < tags_.size(); ++i) {
      if (times[i] == 0)
        complain(about(
            body,
            fmt::format("an element has node {}, which does not exist: write it again with gmsh", tags_[i])));
      if (times[i] > 1 && !in_parts)
        complain(misfit(body, false, fmt::format("node {} occurs twice", tags_[i]), ""));
    }
    for (std::size_t c = 0; c < 3; ++c) {
      std::vector<double>& x = position_[c];
      x.assign(tags_.size(), std::numeric_limits<double>::infinity());
      for (std::size_t i = 0; i < read.node.size(); ++i) {
        double& lowest = x[index(read.node[i])];
        lowest = std::min(lowest, read.position[3 * i + c]);
      }
      x = directory.combined(x, lower);
      for (std::size_t i = 0; i < read.node.size(); ++i)
        if (x[index(read.node[i])] != read.position[3 * i + c])
          complain(misfit(body, in_parts, fmt::format("node {} occurs twice", read.node[i]),
                          fmt::format("node {} lies in different places", read.node[i])));
    }
    agree(comm, complaint);
    for (std::size_t i = 0; i < read.held.size(); ++i) support_[index(read.held[i])] |= read.support[i];
    support_ = directory.combined(support_, [](auto a, auto b) { return a | b; });
  }

  std::size_t index(std::int64_t tag) const {
    return static_cast<std::size_t>(std::ranges::lower_bound(tags_, tag) - tags_.begin());
  }
  double position(std::int64_t tag, std::size_t component) const { return position_[component][index(tag)]; }
  std::int64_t support(std::int64_t tag) const { return support_[index(tag)]; }

 private:
  Numbers tags_;
  std::array<std::vector<double>, 3> position_;
  Numbers support_;
};

/// Sets the nodes of a part, whose blocks identify them by tags, but not yet their supports.
/// @return bits as in Uses::support, for each node
Numbers take_nodes(Part& part, const Records& read, const scene::Body& body, bool in_parts, MPI_Comm comm) {
  collect_tags(part);
  Numbers all = part.tag;
  for (const Numbers* more : {&read.node, &read.held}) all.insert(all.end(), more->begin(), more->end());
  for (const std::vector<Block>* blocks : {&part.contact, &part.loaded})
    for (const Block& block : *blocks) all.insert(all.end(), block.node.begin(), block.node.end());
  sort_once(all);
  const NodeTable table(std::move(all), read, body, in_parts, comm);
  Numbers support;
  for (const std::int64_t tag : part.tag) {
    for (std::size_t c = 0; c < 3; ++c) part.position.push_back(table.position(tag, c));
    support.push_back(table.support(tag));
  }
  return support;
}

/// Sets the supports of the nodes of a part. Collective; throws InputError on every rank if one of them holds
/// no node of the body.
/// @param support  bits as in Uses::support, for each node
void set_supports(Part& part, const Numbers& support, const scene::Body& body, const RequestedGroups& wanted,
                  MPI_Comm comm) {
  std::int64_t used = 0, bit = 1;
  for (const std::int64_t bits : support) used |= bits;
  MPI_Allreduce(MPI_IN_PLACE, &used, 1, MPI_INT64_T, MPI_BOR, comm);
  part.fixed.assign(part.tag.size(), 0);
  for (const auto& [name, components] : body.support) {
    if ((used & bit) == 0) throw holds_nothing(body, name);
    unsigned bits = moved_bit(body, wanted, name);
    for (const char component : components) bits |= 1U << (component - 'x');
    for (std::size_t n = 0; n < support.size(); ++n)
      if ((support[n] & bit) != 0) part.fixed[n] |= bits;
    bit *= 2;
  }
}

/// The facets of all faces on the outside of a part, with nodes identified by tags.
std::vector<Block> facets_outside(const Part& part) {
  std::vector<Block> boundary = boundary_of(part.blocks, part.outside);
  for (Block& block : boundary)
    for (std::int64_t& node : block.node) node = part.tag[static_cast<std::size_t>(node)];
  return boundary;
}

}  // namespace

Part read_share(const MshFiles& files, const scene::Body& body, const RequestedGroups& wanted, MPI_Comm comm,
                MPI_Comm peers, const parallel::Progress& progress) {
  const auto reached = [&](std::int64_t stage) {
    if (progress) progress(stage, 4);
  };
  const bool in_parts = files.path.front() != body.mesh;
  const Uses uses = uses_of(files, body, wanted);
  Records read;
  parallel::on_all_ranks(peers, [&] {  // reading a file may fail on one team only
    parallel::on_all_ranks(comm, [&] { read = RangeReader(files, body, uses, comm).read(); });
  });
  same_types(files, uses, read);
  refuse_repeated_elements(read.body, body, in_parts, comm);
  reached(1);
  Part part;
  part.order = uses.order;
  part.blocks = split(std::exchange(read.body, {}), comm, peers);
  reached(2);
  part.contact = std::move(read.contact);
  part.loaded = std::move(read.loaded);
  set_supports(part, take_nodes(part, read, body, in_parts, comm), body, wanted, comm);
  reached(3);
  part.outside = outside_of(part.blocks);
  part.touches_everywhere = uses.touches_everywhere;
  if (part.touches_everywhere) part.contact = facets_outside(part);
  return part;
}

}  // namespace ricochet::mesh
