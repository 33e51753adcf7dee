// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/read.hpp"

#include <fmt/format.h>
#include <gmsh.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "src/mesh/complaints.hpp"
#include "src/mesh/curved.hpp"
#include "src/mesh/faces.hpp"
#include "src/mesh/file_kinds.hpp"
#include "src/mesh/gmsh_session.hpp"
#include "src/mesh/groups.hpp"
#include "src/mesh/node_order.hpp"
#include "src/mesh/open.hpp"
#include "src/mesh/part.hpp"
#include "src/mesh/rod.hpp"
#include "src/mesh/uses.hpp"

namespace ricochet::mesh {

namespace {

using Tags = std::vector<std::size_t>;

/// Reads one body from its gmsh model.
class MeshReader {
 public:
  MeshReader(const scene::Body& body, const RequestedGroups& asked)
      : body_(body), asked_(asked), file_(body.mesh.filename().string()) {}

  GlobalMesh read(const parallel::Progress& progress) {
    with_gmsh_errors(file_, [&] {
      const auto reached = [&](std::int64_t stage) {
        if (progress) progress(stage, 4);
      };
      open();
      model_ = entities_of_model();
      reached(1);
      mesh_.dim = dimension();
      collect_nodes();
      collect_elements();
      if (!meshed_before_)
        repair_curved(mesh_, file_, index_, body_.scale);
      else if (body_.mesh.extension() != ".msh")
        correct_order();
      reached(2);
      if (mesh_.dim == 1)
        find_axis(mesh_, file_);
      else
        collect_visualisation();
      reached(3);
      collect_facets();
      turn_outward();
      mark_supports();
      drop_unused_nodes();
      reached(4);
    });
    return std::move(mesh_);
  }

 private:
  void open() {
    const Opened opened = open_model(body_);
    meshed_before_ = opened.meshed_before;
    if (!opened.sewn.empty()) mesh_.warnings.push_back(opened.sewn);
  }

  /// Returns the entities of a group. Throws InputError if the mesh does not contain it.
  std::vector<int> entities(int dim, const std::string& group, const std::string& key) const {
    std::vector<int> found = model_.find(dim, group);
    if (found.empty()) throw model_.no_group(dim, group, file_, key);
    return found;
  }

  int dimension() const {
    for (int dim = 3; dim >= 1; --dim) {
      std::vector<int> types;
      gmsh::model::mesh::getElementTypes(types, dim);
      if (types.empty()) continue;
      if (dim == 2) throw no_volume(dim, file_);
      return dim;
    }
    throw no_volume(0, file_);
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
      auto block = std::ranges::find(blocks, types[t], &Block::gmsh_type);
      if (block == blocks.end())
        block = blocks.insert(block, {types[t], checked_reference(types[t], file_).nodes, {}, {}, {}});
      for (std::size_t tag : tags[t]) block->tag.push_back(static_cast<std::int64_t>(tag));
      for (std::size_t node : nodes[t]) block->node.push_back(index_.at(node));
      block->label.insert(block->label.end(), tags[t].size(), label);
    }
  }

  /// Appends the elements of the whole body.
  void append_body(std::int64_t label) {
    for (int entity : model_.grouped(mesh_.dim).entities) append(mesh_.blocks, mesh_.dim, entity, label);
    if (std::string warning = model_.left_out_warning(mesh_.dim, file_, body_.name); !warning.empty())
      mesh_.warnings.push_back(std::move(warning));
  }

  void collect_elements() {
    refuse_lost_elements();
    for (std::size_t m = 0; m < body_.materials.size(); ++m) {
      const std::string& group = body_.materials[m].group;
      if (group.empty()) {
        append_body(static_cast<std::int64_t>(m));
        continue;
      }
      for (int entity : entities(mesh_.dim, group, key_of("material")))
        append(mesh_.blocks, mesh_.dim, entity, static_cast<std::int64_t>(m));
    }
    for (const scene::Material& material : body_.materials) {
      if (mesh_.dim != 1) continue;
      if (!(material.area > 0))
        throw InputError(fmt::format(
            "{}: is a rod (line elements): give bodies.{}.material its cross-section, area = … [m²]", file_,
            body_.name));
      if (!material.isotropic())
        throw InputError(
            fmt::format("{}: is a rod (line elements), which stretches along its axis alone: give "
                        "bodies.{}.material one number as young, and neither stiffness nor shear",
                        file_, body_.name));
    }
    if (mesh_.blocks.empty()) throw no_elements(body_);
    mesh_.order = reference_element(mesh_.blocks.front().gmsh_type).order;
    for (const Block& block : mesh_.blocks)
      if (reference_element(block.gmsh_type).order != mesh_.order) throw mixed_orders(body_);
    refuse_repeated(mesh_.blocks, "element", "material", body_);
    if (!meshed_before_ && mesh_.order != body_.order)
      throw InputError(
          fmt::format("{}: gmsh made elements of order {} instead of {}: choose a lower bodies.{}.order",
                      file_, mesh_.order, body_.order, body_.name));
  }

  /// Refuses a mesh if gmsh would lose some of its elements. gmsh lists the elements of an entity by the type
  /// of the first one and omits elements of another order.
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
    if (static_cast<double>(listed) != all) throw mixed_orders(body_);
  }

  void correct_order() {
    if (const std::int64_t corrected = correct_node_order(mesh_); corrected > 0)
      mesh_.warnings.push_back(
          fmt::format("{}: the nodes of {} elements were in an order in which they are inverted, as other "
                      "programs write them, and were put in gmsh's order",
                      file_, corrected));
  }

  void collect_visualisation() {
    outside_ = outside_of(mesh_.blocks);
    mesh_.visualisation.blocks = triangles_of(outside_, mesh_.order);
  }

  std::string key_of(const char* use) const { return fmt::format("bodies.{}.{}", body_.name, use); }

  void collect_facets() {
    const int dim = mesh_.dim - 1;
    const auto collect = [&](const std::vector<std::string>& groups, const std::string& key,
                             FacetMesh& facets) {
      for (std::size_t g = 0; g < groups.size(); ++g)
        for (int entity : entities(dim, groups[g], key))
          append(facets.blocks, dim, entity, static_cast<std::int64_t>(g));
    };
    if (mesh_.dim == 3 && touches_everywhere(body_, model_)) {
      refuse_more_than_all(body_);
      mesh_.contact.blocks = boundary_of(mesh_.blocks, outside_);
    } else {
      collect(body_.contact, key_of("contact"), mesh_.contact);
    }
    refuse_repeated(mesh_.contact.blocks, dim == 2 ? "facet" : "point", "contact", body_);
    collect(asked_.loaded, traction_key, mesh_.loaded);
  }

  void turn_outward() {
    const auto turn = [&](FacetMesh& facets, const std::string& key) {
      if (mesh_.dim == 1 && !facets.blocks.empty()) orient_ends(mesh_, facets, body_, key);
      for (Block& block : facets.blocks)
        if (mesh_.dim == 3) orient(block, mesh_.order, outside_, body_, key);
    };
    turn(mesh_.contact, key_of("contact"));
    turn(mesh_.loaded, traction_key);
  }

  /// For each node, whether an element uses it.
  std::vector<char> used_nodes() const {
    std::vector<char> used(mesh_.fixed.size(), 0);
    for (const Block& block : mesh_.blocks)
      for (std::int64_t node : block.node) used[static_cast<std::size_t>(node)] = 1;
    return used;
  }

  void mark_supports() {
    const std::vector<char> used = used_nodes();
    for (const auto& [name, components] : body_.support) {
      int dim = mesh_.dim;
      while (dim >= 0 && model_.find(dim, name).empty()) --dim;
      if (dim < 0) dim = mesh_.dim - 1;  // for the error message
      unsigned bits = moved_bit(body_, asked_, name);
      if (mesh_.dim == 3) {
        for (char component : components) bits |= 1u << (component - 'x');
      } else {
        // A rod moves only along its axis, so a support holds it if it holds any component of the axis.
        for (char component : components)
          if (std::abs(mesh_.axis[component - 'x']) > 1e-12) bits |= 1;
      }
      bool any = false;
      for (int entity : entities(dim, name, key_of("support"))) {
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
      if (!any) throw holds_nothing(body_, name);
    }
  }

  /// Removes nodes that no element uses, such as centres of arcs and nodes of elements of another dimension.
  void drop_unused_nodes() {
    const std::vector<char> used = used_nodes();
    std::vector<std::int64_t> rank(used.size(), -1);
    std::int64_t next = 0;
    for (std::size_t n = 0; n < rank.size(); ++n) {
      if (used[n] == 0) continue;
      for (int c = 0; c < 3; ++c) mesh_.position[3 * next + c] = mesh_.position[3 * n + c];
      mesh_.fixed[next] = mesh_.fixed[n];
      for (FacetMesh* facets : {&mesh_.contact, &mesh_.loaded})
        for (std::size_t c = 0; c < 3 && !facets->end_normal.empty(); ++c)
          facets->end_normal[3 * static_cast<std::size_t>(next) + c] = facets->end_normal[3 * n + c];
      rank[n] = next++;
    }
    mesh_.position.resize(3 * static_cast<std::size_t>(next));
    mesh_.fixed.resize(static_cast<std::size_t>(next));
    for (FacetMesh* facets : {&mesh_.contact, &mesh_.loaded})
      if (!facets->end_normal.empty()) facets->end_normal.resize(3 * static_cast<std::size_t>(next));
    for (std::vector<Block>* blocks :
         {&mesh_.blocks, &mesh_.contact.blocks, &mesh_.loaded.blocks, &mesh_.visualisation.blocks})
      for (Block& block : *blocks)
        for (std::int64_t& node : block.node) {
          node = rank[static_cast<std::size_t>(node)];
          if (node < 0) throw foreign_nodes(body_);
        }
    if (mesh_.dim == 1) mesh_.visualisation.blocks.push_back(lines_of(mesh_.blocks));
  }

  const scene::Body& body_;
  const RequestedGroups& asked_;
  std::string file_;
  bool meshed_before_ = false;
  Entities model_;
  GlobalMesh mesh_;
  std::unordered_map<std::size_t, std::int64_t> index_;
  Faces outside_;
};

}  // namespace

GlobalMesh read_mesh(const scene::Body& body, const parallel::Progress& progress,
                     const RequestedGroups& asked) {
  return MeshReader(body, asked).read(progress);
}

}  // namespace ricochet::mesh
