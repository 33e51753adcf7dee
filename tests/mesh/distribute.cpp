// SPDX-License-Identifier: BSD-2-Clause
// The parts of a mesh on any number of ranks, compared with the mesh on one rank.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "src/mesh/partition.hpp"
#include "src/mesh/read.hpp"
#include "tests/mesh/files.hpp"
#include "tests/meshes.hpp"

namespace ricochet {
namespace distribute_test {

using mesh::Mesh;

std::string chain_geo(int elements) {
  return fmt::format(
      "Point(1) = {{0,0,0}};\nPoint(2) = {{2,0,0}};\nLine(1) = {{1,2}};\nTransfinite Curve{{1}} = {};\n"
      "Physical Curve(\"body\") = {{1}};\nPhysical Point(\"top\") = {{2}};\n",
      elements + 1);
}

/// A cube of hexahedra beside a cube of prisms. They share the square x = 1.
std::string hexahedra_beside_prisms() {
  return "SetFactory(\"Built-in\");\nPoint(1) = {0,0,0};\nPoint(2) = {1,0,0};\nPoint(3) = {1,1,0};\nPoint(4) "
         "= {0,1,0};\n"
         "Point(5) = {2,0,0};\nPoint(6) = {2,1,0};\nLine(1) = {1,2};\nLine(2) = {2,3};\nLine(3) = "
         "{3,4};\nLine(4) = {4,1};\n"
         "Line(5) = {2,5};\nLine(6) = {5,6};\nLine(7) = {6,3};\nCurve Loop(1) = {1,2,3,4};\nCurve Loop(2) = "
         "{5,6,7,-2};\n"
         "Plane Surface(1) = {1};\nPlane Surface(2) = {2};\nTransfinite Curve{1:7} = 3;\nTransfinite "
         "Surface{1:2};\n"
         "Recombine Surface{1};\na[] = Extrude {0,0,1} { Surface{1}; Layers{2}; Recombine; };\n"
         "b[] = Extrude {0,0,1} { Surface{2}; Layers{2}; Recombine; };\nPhysical Volume(\"left\") = {a[1]};\n"
         "Physical Volume(\"body\") = {b[1]};\nPhysical Surface(\"top\") = {a[0], b[0]};\n";
}

struct Case {
  std::string name, extension, text;
  int order;
};

class Distribute : public testing::TestWithParam<Case> {
 protected:
  Distribute() : file_(GetParam().extension, GetParam().text) {
    scene::Body body = test::body_of(file_.path(), GetParam().order);
    if (GetParam().extension == ".geo") body.contact = {"top"};
    if (GetParam().name == "mixed") {
      body.materials.push_back(body.materials[0]);
      body.materials[0].group = "body";
      body.materials[1].group = "left";
    }
    if (GetParam().extension == ".geo") body.support = {{"top", "x"}};
    // Each rank reads the mesh itself, which gives a reference that is independent of the number of ranks.
    whole_ = mesh::distribute(mesh::read_mesh(body), PETSC_COMM_SELF);
    mesh_ = test::mesh_of(body);
  }
  bool owns(std::int64_t node) const {
    return node >= mesh_.first_node && node < mesh_.first_node + mesh_.owned_nodes;
  }
  /// Elements by tag. The values are the gmsh type, the material and the reading numbers of the nodes.
  static std::map<std::int64_t, std::vector<std::int64_t>> elements(const Mesh& mesh, bool own_only) {
    std::map<std::int64_t, std::vector<std::int64_t>> found;
    for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
      const mesh::Block& block = mesh.blocks[b];
      for (std::size_t e = 0; e < block.size(); ++e) {
        if (own_only && mesh.own[b][e] == 0) continue;
        std::vector<std::int64_t>& element = found[block.tag[e]];
        EXPECT_TRUE(element.empty()) << "twice on one rank: " << block.tag[e];
        element = {block.gmsh_type, block.label[e]};
        for (int k = 0; k < block.nodes_per_element; ++k)
          element.push_back(
              mesh.canonical[static_cast<std::size_t>(block.node[e * block.nodes_per_element + k])]);
      }
    }
    return found;
  }

  mesh::GmshSession gmsh_;
  test::SharedFile file_;
  Mesh whole_, mesh_;
};

TEST_P(Distribute, every_node_is_owned_once_in_rank_order) {
  const int ranks = parallel::size_of(mesh_.comm), me = parallel::rank_of(mesh_.comm);
  std::vector<double> first(static_cast<std::size_t>(ranks) + 1, 0);
  first[static_cast<std::size_t>(me)] = static_cast<double>(mesh_.first_node);
  parallel::sum(mesh_.comm, first);
  first.back() = static_cast<double>(mesh_.total_nodes);
  EXPECT_EQ(first.front(), 0);
  EXPECT_EQ(first[static_cast<std::size_t>(me) + 1],
            static_cast<double>(mesh_.first_node + mesh_.owned_nodes));
  EXPECT_EQ(mesh_.total_nodes, whole_.total_nodes);
  EXPECT_EQ(mesh_.total_elements, whole_.total_elements);
  EXPECT_EQ(mesh_.dim, whole_.dim);
  EXPECT_EQ(mesh_.order, whole_.order);
  EXPECT_EQ(mesh_.axis, whole_.axis);

  // Each rank holds the nodes that it owns, and each reading number is owned by exactly one rank.
  EXPECT_TRUE(std::is_sorted(mesh_.node.begin(), mesh_.node.end()));
  std::vector<double> owners(static_cast<std::size_t>(mesh_.total_nodes), 0);
  std::int64_t owned = 0;
  for (std::size_t i = 0; i < mesh_.node.size(); ++i)
    if (owns(mesh_.node[i])) {
      ++owned;
      owners[static_cast<std::size_t>(mesh_.canonical[i])] += 1;
    }
  EXPECT_EQ(owned, mesh_.owned_nodes);
  parallel::sum(mesh_.comm, owners);
  EXPECT_EQ(owners, std::vector<double>(owners.size(), 1));
  // With enough elements, METIS assigns some to every rank.
  if (mesh_.total_elements >= 8 * ranks) {
    EXPECT_GT(mesh_.owned_nodes, 0);
  }
}

TEST_P(Distribute, nodes_keep_their_positions_and_supports) {
  ASSERT_EQ(whole_.node.size(), static_cast<std::size_t>(whole_.total_nodes));
  std::map<std::int64_t, std::size_t> of;
  for (std::size_t i = 0; i < whole_.node.size(); ++i) of[whole_.canonical[i]] = i;
  for (std::size_t i = 0; i < mesh_.node.size(); ++i) {
    const std::size_t j = of.at(mesh_.canonical[i]);
    for (int c = 0; c < 3; ++c) EXPECT_EQ(mesh_.position[3 * i + c], whole_.position[3 * j + c]);
    EXPECT_EQ(mesh_.fixed[i], whole_.fixed[j]);
  }
}

TEST_P(Distribute, every_element_is_own_once_and_held_wherever_one_of_its_nodes_is_owned) {
  const auto all = elements(whole_, false), here = elements(mesh_, false), own = elements(mesh_, true);
  EXPECT_EQ(static_cast<std::int64_t>(all.size()), mesh_.total_elements);
  EXPECT_EQ(parallel::sum(mesh_.comm, static_cast<std::int64_t>(own.size())), mesh_.total_elements);
  std::set<std::int64_t> owned;  // reading numbers
  for (std::size_t i = 0; i < mesh_.node.size(); ++i)
    if (owns(mesh_.node[i])) owned.insert(mesh_.canonical[i]);
  std::vector<double> times;
  for (const auto& [tag, element] : all) {
    times.push_back(static_cast<double>(own.count(tag)));
    const bool touches =
        std::any_of(element.begin() + 2, element.end(), [&](std::int64_t n) { return owned.count(n) > 0; });
    EXPECT_EQ(here.count(tag), touches || own.count(tag) > 0 ? 1U : 0U) << tag;
    if (here.count(tag) > 0) {
      EXPECT_EQ(here.at(tag), element) << tag;
    }
  }
  parallel::sum(mesh_.comm, times);
  EXPECT_EQ(times, std::vector<double>(times.size(), 1));
}

TEST_P(Distribute, contact_surface_is_complete_on_every_rank_and_the_visualisation_surface_on_the_first) {
  const auto expect_same = [&](const mesh::FacetMesh& got, const mesh::FacetMesh& wanted) {
    EXPECT_EQ(got.position, wanted.position);
    EXPECT_EQ(got.end_normal, wanted.end_normal);
    ASSERT_EQ(got.blocks.size(), wanted.blocks.size());
    for (std::size_t b = 0; b < got.blocks.size(); ++b) {
      EXPECT_EQ(got.blocks[b].gmsh_type, wanted.blocks[b].gmsh_type);
      EXPECT_EQ(got.blocks[b].node, wanted.blocks[b].node);
      EXPECT_EQ(got.blocks[b].tag, wanted.blocks[b].tag);
      EXPECT_EQ(got.blocks[b].label, wanted.blocks[b].label);
    }
    // The global numbers of the nodes of this rank refer to the same positions.
    for (std::size_t i = 0; i < got.node.size(); ++i) {
      const auto local =
          std::lower_bound(mesh_.node.begin(), mesh_.node.end(), got.node[i]) - mesh_.node.begin();
      if (!owns(got.node[i])) continue;
      for (int c = 0; c < 3; ++c)
        EXPECT_EQ(mesh_.position[3 * static_cast<std::size_t>(local) + c], got.position[3 * i + c]);
    }
  };
  expect_same(mesh_.contact, whole_.contact);
  EXPECT_EQ(mesh_.contact.blocks.empty(), GetParam().extension == ".msh");
  if (parallel::rank_of(mesh_.comm) == 0) expect_same(mesh_.visualisation, whole_.visualisation);
}

INSTANTIATE_TEST_SUITE_P(Meshes, Distribute,
                         testing::Values(Case{"tet1", ".geo", test::block_geo("tet", 4, 0.3), 1},
                                         Case{"tet3", ".geo", test::block_geo("tet", 2, 0.3), 3},
                                         Case{"hex2", ".geo", test::block_geo("hex", 3, 0), 2},
                                         Case{"prism2", ".geo", test::prism_geo(3), 2},
                                         Case{"mixed", ".geo", hexahedra_beside_prisms(), 2},
                                         Case{"rod", ".geo", chain_geo(20), 3},
                                         // Fewer elements than ranks.
                                         Case{"rod_of_one", ".geo", chain_geo(1), 1},
                                         Case{"hex_alone", ".msh", test::one_hexahedron("1 2 3 4 5 6 7 8"),
                                              1},
                                         Case{"two_tets", ".msh", test::two_tetrahedra_41("1 3 2 5"), 1}),
                         [](const auto& it) { return it.param.name; });

}  // namespace distribute_test
}  // namespace ricochet
