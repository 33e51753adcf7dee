// SPDX-License-Identifier: BSD-2-Clause
#include "src/mesh/body_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "src/mesh/complaints.hpp"
#include "src/mesh/faces.hpp"

namespace ricochet::mesh {

namespace {

using base::hdf5::any;
using base::hdf5::Reader;

constexpr std::int64_t version = 1;

/// A kind of facet, identified by its number of nodes. Nodes are in the order of gmsh.
struct FacetKind {
  int nodes, gmsh_type, order;
};
constexpr FacetKind facet_kinds[] = {{3, 2, 1}, {6, 9, 2}, {10, 21, 3}, {4, 3, 1}, {9, 10, 2}, {16, 36, 3}};

class Content {
 public:
  Content(const scene::Body& body, const RequestedGroups& asked)
      : body_(body), asked_(asked), file_(open_body_file(body.mesh)) {}

  GlobalMesh read() {
    mesh_.position = file_.read<double>("/node", {any, 3});
    if (mesh_.position.empty()) file_.fail("dataset \"/node\" is empty.");
    for (const double x : mesh_.position)
      if (!std::isfinite(x)) file_.fail("dataset \"/node\" contains a position that is not finite.");
    mesh_.fixed.assign(mesh_.position.size() / 3, 0);
    collect(body_.contact, fmt::format("bodies.{}.contact", body_.name), mesh_.contact);
    collect(asked_.loaded, "loads.traction.group", mesh_.loaded);
    collect_visualisation();
    mark_supports();
    return std::move(mesh_);
  }

 private:
  void check_nodes(const std::string& dataset, const std::vector<std::int64_t>& nodes) const {
    const auto count = static_cast<std::int64_t>(mesh_.fixed.size());
    for (const std::int64_t node : nodes)
      if (node < 0 || node >= count)
        file_.fail(fmt::format("dataset \"{}\" names node {}: nodes are numbered 0 to {}.", dataset, node,
                               count - 1));
  }

  std::vector<std::int64_t> facets_of(const std::string& name, const FacetKind& kind) const {
    const std::string dataset = fmt::format("/surface/{}/{}", name, kind.nodes);
    if (!file_.exists(dataset)) return {};
    auto nodes = file_.read<std::int64_t>(dataset, {any, static_cast<std::size_t>(kind.nodes)});
    check_nodes(dataset, nodes);
    return nodes;
  }

  void collect(const std::vector<std::string>& names, const std::string& key, FacetMesh& facets) {
    for (std::size_t g = 0; g < names.size(); ++g) {
      bool any_facet = false;
      for (const FacetKind& kind : facet_kinds) {
        const std::vector<std::int64_t> nodes = facets_of(names[g], kind);
        if (nodes.empty()) continue;
        any_facet = true;
        auto block = std::ranges::find(facets.blocks, kind.gmsh_type, &Block::gmsh_type);
        if (block == facets.blocks.end())
          block = facets.blocks.insert(block, {kind.gmsh_type, kind.nodes, {}, {}, {}});
        for (std::size_t e = 0; e < nodes.size() / static_cast<std::size_t>(kind.nodes); ++e)
          block->tag.push_back(static_cast<std::int64_t>(e));
        block->node.insert(block->node.end(), nodes.begin(), nodes.end());
        block->label.resize(block->tag.size(), static_cast<std::int64_t>(g));
        mesh_.order = std::max(mesh_.order, kind.order);
      }
      if (!any_facet)
        file_.fail(fmt::format(
            "has no surface \"{0}\", which {1} names: write its facets as /surface/{0}/3 (triangles), or 4, "
            "6, 9, 10, 16 for so many nodes, or change {1}.",
            names[g], key));
    }
  }

  /// Reads the visualisation surface: the triangles of the file if it has any, otherwise the contact surface.
  void collect_visualisation() {
    if (!file_.exists("/skin")) {
      mesh_.visualisation.blocks = triangles_of(mesh_.contact.blocks);
      return;
    }
    Block surface{2, 3, file_.read<std::int64_t>("/skin", {any, 3}), {}, {}};
    check_nodes("/skin", surface.node);
    surface.tag.assign(surface.node.size() / 3, 0);
    surface.label = surface.tag;
    mesh_.visualisation.blocks.push_back(std::move(surface));
  }

  std::vector<std::int64_t> nodes_of(const std::string& name) const {
    const std::string dataset = "/nodes/" + name;
    std::vector<std::int64_t> nodes;
    if (file_.exists(dataset)) {
      nodes = file_.read<std::int64_t>(dataset, {any});
      check_nodes(dataset, nodes);
      return nodes;
    }
    for (const FacetKind& kind : facet_kinds) {
      const auto of_kind = facets_of(name, kind);
      nodes.insert(nodes.end(), of_kind.begin(), of_kind.end());
    }
    return nodes;
  }

  void mark_supports() {
    for (const auto& [name, components] : body_.support) {
      const std::vector<std::int64_t> nodes = nodes_of(name);
      if (nodes.empty())
        file_.fail(
            fmt::format("has no nodes \"{0}\", which bodies.{1}.support holds: write them as "
                        "/nodes/{0}, or a surface of that name, or change bodies.{1}.support.",
                        name, body_.name));
      unsigned bits = moved_bit(body_, asked_, name);
      for (const char component : components) bits |= 1U << (component - 'x');
      for (const std::int64_t node : nodes) mesh_.fixed[static_cast<std::size_t>(node)] |= bits;
    }
  }

  const scene::Body& body_;
  const RequestedGroups& asked_;
  Reader file_;
  GlobalMesh mesh_;
};

}  // namespace

Reader open_body_file(const std::filesystem::path& path) {
  Reader file(path, body_file_advice);
  if (!file.has_attribute("/", "format") || file.string_attribute("/", "format") != "ricochet-body")
    file.fail("is not a body file (its attribute \"format\" is not \"ricochet-body\").");
  if (const std::int64_t found = file.integer_attribute("/", "version"); found != version)
    file.fail(fmt::format("has version {}; this program reads version {}.", found, version));
  return file;
}

GlobalMesh read_body_file(const scene::Body& body, const RequestedGroups& asked) {
  return Content(body, asked).read();
}

}  // namespace ricochet::mesh
