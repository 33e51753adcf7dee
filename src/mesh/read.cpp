#include <fmt/format.h>
#include <gmsh.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

#include "src/mesh/gmsh_session.hpp"
#include "src/mesh/groups.hpp"
#include "src/mesh/mesh.hpp"
#include "src/mesh/open.hpp"

namespace ricochet::mesh {

namespace {

using Tags = std::vector<std::size_t>;
using Corners = std::vector<std::int64_t>;

struct Facet {
  std::int64_t count = 0;
  Corners outward;  ///< corners in the order that points out of the body
};

/// gmsh's model of one body, with the lookups that reading needs.
class Reader {
 public:
  explicit Reader(const scene::Body& body) : body_(body), file_(body.mesh.filename().string()) {}

  GlobalMesh read(const parallel::Progress& progress) {
    with_gmsh_errors(file_, [&] {
      const auto reached = [&](std::int64_t stage) {
        if (progress) progress(stage, 4);
      };
      meshed_before_ = open_model(body_);
      reached(1);
      mesh_.dim = dimension();
      collect_nodes();
      collect_elements();
      reached(2);
      mesh_.dim == 1 ? find_axis() : collect_skin();
      reached(3);
      collect_contact();
      mark_supports();
      drop_unused_nodes();
      reached(4);
    });
    return std::move(mesh_);
  }

 private:
  std::string key(const char* last) const { return fmt::format("bodies.{}.{}", body_.name, last); }

  int dimension() const {
    for (int dim = 3; dim >= 1; --dim) {
      std::vector<int> types;
      gmsh::model::mesh::getElementTypes(types, dim);
      if (types.empty()) continue;
      if (dim == 2)
        throw InputError(fmt::format(
            "{}: has surface elements but no volume: mesh the volume (gmsh -3) and give it a physical group",
            file_));
      return dim;
    }
    throw InputError(fmt::format(
        "{}: holds no volume or line elements: mesh it with gmsh first, or name another file", file_));
  }

  void collect_nodes() {
    Tags tags;
    std::vector<double> parametric;
    gmsh::model::mesh::getNodes(tags, mesh_.position, parametric);
    for (double& x : mesh_.position) x *= body_.scale;
    for (std::size_t i = 0; i < tags.size(); ++i) index_[tags[i]] = static_cast<std::int64_t>(i);
    mesh_.fixed.assign(tags.size(), 0);
  }

  /// Appends the elements of one entity (−1: all) to `blocks`.
  void append(std::vector<Block>& blocks, int dim, int entity, std::int64_t label) {
    std::vector<int> types;
    std::vector<Tags> tags, nodes;
    gmsh::model::mesh::getElements(types, tags, nodes, dim, entity);
    for (std::size_t t = 0; t < types.size(); ++t) {
      auto block =
          std::find_if(blocks.begin(), blocks.end(), [&](const Block& b) { return b.gmsh_type == types[t]; });
      if (block == blocks.end()) {
        const ReferenceElement reference = checked_reference(types[t]);
        blocks.push_back({types[t], reference.nodes, {}, {}, {}});
        block = blocks.end() - 1;
      }
      for (std::size_t tag : tags[t]) block->tag.push_back(static_cast<std::int64_t>(tag));
      for (std::size_t node : nodes[t]) block->node.push_back(index_.at(node));
      block->label.insert(block->label.end(), tags[t].size(), label);
    }
  }

  ReferenceElement checked_reference(int type) const {
    try {
      return reference_element(type);
    } catch (const InputError& error) {
      throw InputError(file_ + ": " + error.what());
    }
  }

  void collect_elements() {
    refuse_lost_elements();
    for (std::size_t m = 0; m < body_.materials.size(); ++m) {
      const std::string& group = body_.materials[m].group;
      if (group.empty()) {
        append(mesh_.blocks, mesh_.dim, -1, static_cast<std::int64_t>(m));
        continue;
      }
      for (int entity : entities_of(mesh_.dim, group, file_, key("material")))
        append(mesh_.blocks, mesh_.dim, entity, static_cast<std::int64_t>(m));
    }
    for (const scene::Material& material : body_.materials)
      if (mesh_.dim == 1 && !(material.area > 0))
        throw InputError(fmt::format(
            "{}: is a rod (line elements): give bodies.{}.material its cross-section, area = … [m²]", file_,
            body_.name));
    mesh_.order = checked_reference(mesh_.blocks.front().gmsh_type).order;
    for (const Block& block : mesh_.blocks)
      if (checked_reference(block.gmsh_type).order != mesh_.order)
        throw InputError(fmt::format("{}: mixes element orders: mesh it again with one order", file_));
    refuse_repeated(mesh_.blocks, "element", "material");
    if (!meshed_before_ && mesh_.order != body_.order)
      throw InputError(
          fmt::format("{}: gmsh made elements of order {} instead of {}: choose a lower bodies.{}.order",
                      file_, mesh_.order, body_.order, body_.name));
  }

  /// gmsh lists the elements of an entity by the type of its first one: those of another order would be lost.
  void refuse_lost_elements() const {
    if (mesh_.dim != 3) return;
    std::size_t listed = 0;
    gmsh::vectorpair volumes;
    gmsh::model::getEntities(volumes, 3);
    for (const auto& [dim, tag] : volumes) {
      std::vector<int> types;
      std::vector<Tags> tags, nodes;
      gmsh::model::mesh::getElements(types, tags, nodes, dim, tag);
      for (const Tags& one : tags) listed += one.size();
    }
    double all = 0;
    for (const char* kind : {"Tetrahedra", "Hexahedra", "Prisms", "Pyramids", "Trihedra"}) {
      double count = 0;
      gmsh::option::getNumber(std::string("Mesh.Nb") + kind, count);
      all += count;
    }
    if (static_cast<double>(listed) != all)
      throw InputError(fmt::format("{}: mixes element orders: mesh it again with one order", file_));
  }

  void refuse_repeated(const std::vector<Block>& blocks, const char* what, const char* key) const {
    std::vector<std::int64_t> tags;
    for (const Block& block : blocks) tags.insert(tags.end(), block.tag.begin(), block.tag.end());
    std::sort(tags.begin(), tags.end());
    const auto twice = std::adjacent_find(tags.begin(), tags.end());
    if (twice != tags.end())
      throw InputError(fmt::format("{}: {} {} lies in two groups of bodies.{}.{}: give it to one", file_,
                                   what, *twice, body_.name, key));
  }

  Corners corners_of(const Block& block, std::size_t element, int corners) const {
    const auto begin = block.node.begin() + static_cast<std::ptrdiff_t>(element * block.nodes_per_element);
    return {begin, begin + corners};
  }

  /// Faces that belong to one of the body's elements only, oriented outward. The file may hold other bodies.
  void collect_skin() {
    std::map<Corners, Facet> faces;
    for (const Block& block : mesh_.blocks) {
      const auto pattern = outward_faces(checked_reference(block.gmsh_type).family);
      for (std::size_t e = 0; e < block.size(); ++e)
        for (const std::vector<int>& face : pattern) {
          Corners outward;
          for (int corner : face)
            outward.push_back(block.node[e * block.nodes_per_element + static_cast<std::size_t>(corner)]);
          Corners key = outward;
          std::sort(key.begin(), key.end());
          Facet& stored = faces[key];
          stored.outward = std::move(outward);
          ++stored.count;
        }
    }
    for (auto& [key, facet] : faces)
      if (facet.count == 1) outside_[key] = facet.outward;
    const int triangle = gmsh::model::mesh::getElementType("triangle", 1);
    mesh_.skin.blocks.push_back({triangle, 3, {}, {}, {}});
    Block& skin = mesh_.skin.blocks.back();
    for (const auto& [key, outward] : outside_)
      for (std::size_t c = 2; c < outward.size(); ++c) {
        skin.node.insert(skin.node.end(), {outward[0], outward[c - 1], outward[c]});
        skin.tag.push_back(0);
        skin.label.push_back(0);
      }
  }

  void collect_contact() {
    const int dim = mesh_.dim - 1;
    for (std::size_t g = 0; g < body_.contact.size(); ++g)
      for (int entity : entities_of(dim, body_.contact[g], file_, key("contact")))
        append(mesh_.contact.blocks, dim, entity, static_cast<std::int64_t>(g));
    refuse_repeated(mesh_.contact.blocks, dim == 2 ? "facet" : "point", "contact");
    for (Block& block : mesh_.contact.blocks)
      if (dim == 2) {
        if (checked_reference(block.gmsh_type).order != mesh_.order)
          throw InputError(fmt::format("{}: mixes element orders: mesh it again with one order", file_));
        orient(block);
      } else {
        orient_ends(block);
      }
  }

  /// Turns each facet outward by mirroring its node order: the lattice position (i, j) becomes (j, i).
  void orient(Block& block) const {
    const ReferenceElement reference = reference_element(block.gmsh_type);
    std::vector<int> mirrored(reference.nodes);
    for (int n = 0; n < reference.nodes; ++n)
      for (int k = 0; k < reference.nodes; ++k)
        if (std::abs(reference.node[2 * n] - reference.node[2 * k + 1]) +
                std::abs(reference.node[2 * n + 1] - reference.node[2 * k]) <
            1e-6)
          mirrored[n] = k;
    for (std::size_t e = 0; e < block.size(); ++e) {
      const Corners corners = corners_of(block, e, reference.corners);
      Corners key = corners;
      std::sort(key.begin(), key.end());
      const auto face = outside_.find(key);
      if (face == outside_.end())
        throw InputError(fmt::format(
            "{}: facet {} of bodies.{}.contact is not on the body's surface: contact surfaces bound the body",
            file_, block.tag[e], body_.name));
      const Corners& outward = face->second;
      const auto first =
          static_cast<std::size_t>(std::find(outward.begin(), outward.end(), corners[0]) - outward.begin());
      if (outward[(first + 1) % outward.size()] == corners[1]) continue;
      std::vector<std::int64_t> old(
          block.node.begin() + static_cast<std::ptrdiff_t>(e * reference.nodes),
          block.node.begin() + static_cast<std::ptrdiff_t>((e + 1) * reference.nodes));
      for (int n = 0; n < reference.nodes; ++n) block.node[e * reference.nodes + n] = old[mirrored[n]];
    }
  }

  void find_axis() {
    // The two nodes farthest apart along the first-to-farthest line span the rod.
    const auto at = [&](std::int64_t n, int c) {
      return mesh_.position[3 * static_cast<std::size_t>(n) + c];
    };
    std::map<std::int64_t, int> uses;
    std::vector<std::int64_t> all;
    for (const Block& block : mesh_.blocks) {
      all.insert(all.end(), block.node.begin(), block.node.end());
      for (std::size_t e = 0; e < block.size(); ++e)
        for (std::int64_t corner : corners_of(block, e, 2)) ++uses[corner];
    }
    std::vector<std::int64_t> ends;
    for (const auto& [node, count] : uses)
      if (count == 1) ends.push_back(node);
    if (ends.size() != 2)
      throw InputError(
          fmt::format("{}: a rod is one chain of lines, but this has {} ends", file_, ends.size()));
    double length = 0;
    for (int c = 0; c < 3; ++c) {
      mesh_.axis[c] = at(ends[1], c) - at(ends[0], c);
      length += mesh_.axis[c] * mesh_.axis[c];
    }
    length = std::sqrt(length);
    for (double& x : mesh_.axis) x /= length;
    for (std::int64_t node : all) {
      double along = 0, square = 0;
      for (int c = 0; c < 3; ++c) {
        const double d = at(node, c) - at(ends[0], c);
        along += d * mesh_.axis[c];
        square += d * d;
      }
      if (square - along * along > 1e-12 * length * length)
        throw InputError(
            fmt::format("{}: a rod must be straight; mesh a bent one with volume elements", file_));
    }
  }

  void orient_ends(const Block& block) {
    mesh_.contact.end_normal.assign(mesh_.position.size(), 0);
    for (std::int64_t end : block.node) {
      int touching = 0;
      for (const Block& lines : mesh_.blocks)
        for (std::size_t e = 0; e < lines.size(); ++e) {
          const Corners corners = corners_of(lines, e, 2);
          if (corners[0] != end && corners[1] != end) continue;
          ++touching;
          const double area = body_.materials[static_cast<std::size_t>(lines.label[e])].area;
          const std::int64_t other = corners[0] == end ? corners[1] : corners[0];
          double side = 0;
          for (int c = 0; c < 3; ++c)
            side += (mesh_.position[3 * end + c] - mesh_.position[3 * other + c]) * mesh_.axis[c];
          for (int c = 0; c < 3; ++c)
            mesh_.contact.end_normal[3 * end + c] = (side > 0 ? area : -area) * mesh_.axis[c];
        }
      if (touching != 1)
        throw InputError(
            fmt::format("{}: bodies.{}.contact has a point that is not an end of the rod: name its ends",
                        file_, body_.name));
    }
  }

  void mark_supports() {
    std::vector<char> used(mesh_.fixed.size(), 0);
    for (const Block& block : mesh_.blocks)
      for (std::int64_t node : block.node) used[static_cast<std::size_t>(node)] = 1;
    for (const auto& [name, components] : body_.support) {
      int dim = mesh_.dim;
      while (dim >= 0 && find_entities(dim, name).empty()) --dim;
      if (dim < 0) dim = mesh_.dim - 1;  // for the complaint
      unsigned bits = 0;
      if (mesh_.dim == 3) {
        for (char component : components) bits |= 1u << (component - 'x');
      } else {
        // A rod moves along its axis only: holding any component the axis has holds it.
        for (char component : components)
          if (std::abs(mesh_.axis[component - 'x']) > 1e-12) bits = 1;
      }
      bool any = false;
      for (int entity : entities_of(dim, name, file_, key("support"))) {
        std::vector<int> types;
        std::vector<Tags> tags, nodes;
        gmsh::model::mesh::getElements(types, tags, nodes, dim, entity);
        for (const Tags& list : nodes)
          for (std::size_t tag : list) {
            const auto node = static_cast<std::size_t>(index_.at(tag));
            mesh_.fixed[node] |= bits;
            any = any || used[node] != 0;
          }
      }
      if (!any)
        throw InputError(fmt::format("{}: bodies.{}.support.{} holds no node of the body: name a group on it",
                                     file_, body_.name, name));
    }
  }

  /// A .msh may hold nodes that no element uses (centres of arcs, other dimensions).
  void drop_unused_nodes() {
    std::vector<std::int64_t> rank(mesh_.fixed.size(), -1);
    for (const Block& block : mesh_.blocks)
      for (std::int64_t node : block.node) rank[static_cast<std::size_t>(node)] = 0;
    std::int64_t next = 0;
    for (std::size_t n = 0; n < rank.size(); ++n) {
      if (rank[n] < 0) continue;
      for (int c = 0; c < 3; ++c) mesh_.position[3 * next + c] = mesh_.position[3 * n + c];
      mesh_.fixed[next] = mesh_.fixed[n];
      if (!mesh_.contact.end_normal.empty())
        for (int c = 0; c < 3; ++c)
          mesh_.contact.end_normal[3 * next + c] = mesh_.contact.end_normal[3 * n + c];
      rank[n] = next++;
    }
    mesh_.position.resize(3 * static_cast<std::size_t>(next));
    mesh_.fixed.resize(static_cast<std::size_t>(next));
    if (!mesh_.contact.end_normal.empty())
      mesh_.contact.end_normal.resize(3 * static_cast<std::size_t>(next));
    for (std::vector<Block>* blocks : {&mesh_.blocks, &mesh_.contact.blocks, &mesh_.skin.blocks})
      for (Block& block : *blocks)
        for (std::int64_t& node : block.node) {
          node = rank[static_cast<std::size_t>(node)];
          if (node < 0)
            throw InputError(fmt::format(
                "{}: bodies.{}.contact has nodes that are not the body's: mesh surface and volume together",
                file_, body_.name));
        }
    if (mesh_.dim == 1) {
      mesh_.skin.blocks.push_back({gmsh::model::mesh::getElementType("line", 1), 2, {}, {}, {}});
      Block& skin = mesh_.skin.blocks.back();
      for (const Block& block : mesh_.blocks)
        for (std::size_t e = 0; e < block.size(); ++e) {
          const Corners corners = corners_of(block, e, 2);
          skin.node.insert(skin.node.end(), corners.begin(), corners.end());
          skin.tag.push_back(0);
          skin.label.push_back(0);
        }
    }
  }

  const scene::Body& body_;
  std::string file_;
  bool meshed_before_ = false;
  GlobalMesh mesh_;
  std::unordered_map<std::size_t, std::int64_t> index_;
  std::map<Corners, Corners> outside_;
};

}  // namespace

GlobalMesh read_mesh(const scene::Body& body, const parallel::Progress& progress) {
  return Reader(body).read(progress);
}

}  // namespace ricochet::mesh
