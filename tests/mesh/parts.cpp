// SPDX-License-Identifier: BSD-2-Clause
// A mesh in one or several files, of which each rank reads a range, compared with the same mesh as gmsh reads
// it on each rank.
#include "src/mesh/parts.hpp"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <set>

#include "src/mesh/open.hpp"
#include "src/mesh/partition.hpp"
#include "src/mesh/read.hpp"
#include "src/scene/parts.hpp"
#include "tests/mesh/split.hpp"
#include "tests/meshes.hpp"
#include "tests/modes/dense.hpp"

namespace ricochet {
namespace parts_test {

using mesh::Mesh;
using test::me;
using test::SharedFolder;
using Place = std::array<double, 3>;

/// Two separate cubes of different materials. Surfaces and volumes have groups of the same numbers.
std::string two_cubes() {
  return "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 1, 1, 1};\nBox(2) = {2, 0, 0, 1, 1, 1};\n"
         "Transfinite Curve{:} = 3;\nTransfinite Surface{:};\nTransfinite Volume{:};\nPhysical "
         "Volume(\"left\", 1) = {1};\nPhysical Volume(\"right\", 2) = "
         "{2};\n"
         "Physical Surface(\"bottom\", 1) = {5};\nPhysical Surface(\"top\", 2) = {6, 12};\n";
}

struct Case {
  std::string name, geo;
  int parts;  ///< files; 0: one that is not called a part
  bool binary = false;
};

class Parts : public testing::TestWithParam<Case> {
 protected:
  Parts() {
    test::write_both(folder_, GetParam().geo, 2, GetParam().parts, GetParam().binary);
    scene::Body body = test::body_of(folder_ / "whole.msh", 2);
    body.contact = {"top"};
    body.support = {{"bottom", "xz"}};
    if (GetParam().name == "cubes") {
      body.materials.push_back(body.materials[0]);
      body.materials[0].group = "left";
      body.materials[1].group = "right";
      body.materials[1].density = 5;
    }
    materials_ = body.materials;
    gmsh_ = std::make_unique<mesh::GmshSession>();
    whole_ = mesh::distribute(mesh::read_mesh(body), PETSC_COMM_SELF);
    body.mesh = folder_ / "split.msh";
    EXPECT_EQ(scene::part_files(body.mesh).size(), static_cast<std::size_t>(GetParam().parts));
    mesh_ = test::mesh_of(body);
    body_ = body;
    for (std::size_t i = 0; i < whole_.node.size(); ++i) whole_index_[place(whole_.position, i)] = i;
    for (std::size_t i = 0; i < mesh_.node.size(); ++i)
      in_whole_.push_back(whole_index_.at(place(mesh_.position, i)));
  }

  static Place place(const std::vector<double>& position, std::size_t node) {
    return {position[3 * node], position[3 * node + 1], position[3 * node + 2]};
  }
  bool owns(std::int64_t node) const {
    return node >= mesh_.first_node && node < mesh_.first_node + mesh_.owned_nodes;
  }
  /// Elements by the positions of their nodes, in order. The values are the materials.
  static std::map<std::vector<Place>, std::int64_t> elements(const Mesh& mesh, bool own_only) {
    std::map<std::vector<Place>, std::int64_t> found;
    for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
      const mesh::Block& block = mesh.blocks[b];
      const auto width = static_cast<std::size_t>(block.nodes_per_element);
      for (std::size_t e = 0; e < block.size(); ++e) {
        if (own_only && mesh.own[b][e] == 0) continue;
        std::vector<Place> nodes;
        for (std::size_t k = 0; k < width; ++k)
          nodes.push_back(place(mesh.position, static_cast<std::size_t>(block.node[e * width + k])));
        EXPECT_TRUE(found.emplace(nodes, block.label[e]).second) << "twice on one rank: " << block.tag[e];
      }
    }
    return found;
  }
  /// Facets by the positions of their nodes. They are rotated so that the lowest corner
  /// comes first, with unchanged orientation.
  static std::multiset<std::vector<Place>> facets(const mesh::FacetMesh& mesh) {
    std::multiset<std::vector<Place>> found;
    for (const mesh::Block& block : mesh.blocks) {
      const auto width = static_cast<std::size_t>(block.nodes_per_element);
      const auto corners = static_cast<std::size_t>(mesh::reference_element(block.gmsh_type).corners);
      for (std::size_t e = 0; e < block.size(); ++e) {
        std::vector<Place> nodes;
        for (std::size_t k = 0; k < width; ++k)
          nodes.push_back(place(mesh.position, static_cast<std::size_t>(block.node[e * width + k])));
        const auto turned = nodes.begin() + static_cast<std::ptrdiff_t>(corners);
        std::rotate(nodes.begin(), std::min_element(nodes.begin(), turned), turned);
        std::sort(turned, nodes.end());
        found.insert(nodes);
      }
    }
    return found;
  }

  SharedFolder folder_;
  std::unique_ptr<mesh::GmshSession> gmsh_;
  std::vector<scene::Material> materials_;
  scene::Body body_;  ///< in parts
  Mesh whole_, mesh_;
  std::map<Place, std::size_t> whole_index_;
  std::vector<std::size_t> in_whole_;  ///< index in the whole mesh, per local node
};

TEST_P(Parts, give_each_node_to_one_rank_in_rank_order) {
  const auto ranks = static_cast<std::size_t>(parallel::size_of(mesh_.comm));
  std::vector<double> first(ranks + 1, 0), owners(whole_.node.size(), 0);
  first[static_cast<std::size_t>(me())] = static_cast<double>(mesh_.first_node);
  parallel::sum(mesh_.comm, first);
  first.back() = static_cast<double>(mesh_.total_nodes);
  EXPECT_EQ(first.front(), 0);
  EXPECT_EQ(first[static_cast<std::size_t>(me()) + 1],
            static_cast<double>(mesh_.first_node + mesh_.owned_nodes));
  EXPECT_EQ(mesh_.total_nodes, whole_.total_nodes);
  EXPECT_EQ(mesh_.total_elements, whole_.total_elements);
  EXPECT_EQ(mesh_.order, whole_.order);
  EXPECT_EQ(mesh_.dim, whole_.dim);
  EXPECT_EQ(std::adjacent_find(mesh_.node.begin(), mesh_.node.end(), std::greater_equal<>()),
            mesh_.node.end());
  for (std::size_t i = 0; i < mesh_.node.size(); ++i)
    if (owns(mesh_.node[i])) owners[in_whole_[i]] += 1;
  parallel::sum(mesh_.comm, owners);
  EXPECT_EQ(owners, std::vector<double>(owners.size(), 1));
  EXPECT_GT(mesh_.owned_nodes, 0);  // however many files there are
}

TEST_P(Parts, have_the_extent_of_the_complete_mesh) {
  const mesh::Extent extent = mesh::extent_of(body_);
  EXPECT_NEAR(extent.length, GetParam().name == "cubes" ? 3 : 1, 1e-12);
  EXPECT_EQ(extent.dimension, 3);
}

TEST_P(Parts, have_the_supports_and_connected_parts_of_the_complete_mesh) {
  EXPECT_EQ(mesh_.parts, whole_.parts);
  EXPECT_EQ(whole_.parts, GetParam().name == "cubes" ? 2 : 1);
  std::map<std::int64_t, std::set<std::int64_t>> seen;
  for (std::size_t i = 0; i < mesh_.node.size(); ++i) {
    EXPECT_EQ(mesh_.fixed[i], whole_.fixed[in_whole_[i]]);
    seen[mesh_.part[i]].insert(whole_.part[in_whole_[i]]);
    EXPECT_LT(mesh_.part[i], mesh_.parts);
  }
  for (const auto& [part, of_whole] : seen) EXPECT_EQ(of_whole.size(), 1U);
  EXPECT_GT(std::count(whole_.fixed.begin(), whole_.fixed.end(), 5), 0);
}

TEST_P(Parts, have_numbers_that_do_not_depend_on_ranks) {
  // Each number denotes the same node on all ranks.
  std::vector<double> number(whole_.node.size(), 0), holders(number.size(), 0);
  for (std::size_t i = 0; i < mesh_.node.size(); ++i) {
    number[in_whole_[i]] += static_cast<double>(mesh_.canonical[i]);
    holders[in_whole_[i]] += 1;
  }
  parallel::sum(mesh_.comm, number);
  parallel::sum(mesh_.comm, holders);
  std::set<std::int64_t> distinct;
  for (std::size_t i = 0; i < mesh_.node.size(); ++i)
    EXPECT_EQ(number[in_whole_[i]] / holders[in_whole_[i]], static_cast<double>(mesh_.canonical[i]));
  for (std::size_t i = 0; i < number.size(); ++i)
    distinct.insert(static_cast<std::int64_t>(number[i] / holders[i]));
  EXPECT_EQ(distinct.size(), whole_.node.size());
  EXPECT_EQ(*distinct.begin(), 0);
  EXPECT_EQ(*distinct.rbegin(), mesh_.total_nodes - 1);
}

TEST_P(Parts, give_each_element_to_one_rank_and_to_all_that_own_one_of_its_nodes) {
  const auto all = elements(whole_, false), here = elements(mesh_, false), own = elements(mesh_, true);
  std::set<Place> owned;
  for (std::size_t i = 0; i < mesh_.node.size(); ++i)
    if (owns(mesh_.node[i])) owned.insert(place(mesh_.position, i));
  std::vector<double> times;
  for (const auto& [nodes, material] : all) {
    times.push_back(static_cast<double>(own.count(nodes)));
    const bool touches =
        std::any_of(nodes.begin(), nodes.end(), [&](const Place& x) { return owned.count(x) > 0; });
    ASSERT_EQ(here.count(nodes), touches || own.count(nodes) > 0 ? 1U : 0U);
    if (here.count(nodes) > 0) {
      EXPECT_EQ(here.at(nodes), material);
    }
  }
  parallel::sum(mesh_.comm, times);
  EXPECT_EQ(times, std::vector<double>(times.size(), 1));
}

TEST_P(Parts, have_the_surfaces_of_the_complete_mesh) {
  EXPECT_FALSE(whole_.contact.blocks.empty());
  EXPECT_EQ(facets(mesh_.contact), facets(whole_.contact));
  const auto expect_numbers = [&](const mesh::FacetMesh& mesh) {
    for (std::size_t i = 0; i < mesh.node.size(); ++i) {
      if (!owns(mesh.node[i])) continue;
      const auto local = static_cast<std::size_t>(
          std::lower_bound(mesh_.node.begin(), mesh_.node.end(), mesh.node[i]) - mesh_.node.begin());
      EXPECT_EQ(place(mesh_.position, local), place(mesh.position, i));
    }
  };
  expect_numbers(mesh_.contact);
  for (const mesh::Block& block : mesh_.contact.blocks)
    EXPECT_TRUE(std::is_sorted(block.tag.begin(), block.tag.end()));
  if (me() == 0) {
    EXPECT_EQ(facets(mesh_.visualisation), facets(whole_.visualisation));
    expect_numbers(mesh_.visualisation);
  } else {
    EXPECT_TRUE(mesh_.visualisation.blocks.empty());
  }
}

// Without the faces between parts, which each part has on its outside.
TEST_P(Parts, have_the_whole_boundary_of_the_complete_mesh) {
  body_.contact = {"all"};
  const Mesh split = test::mesh_of(body_);
  body_.mesh = folder_ / "whole.msh";
  const Mesh whole = mesh::distribute(mesh::read_mesh(body_), PETSC_COMM_SELF);
  EXPECT_GT(facets(whole.contact).size(), facets(whole_.contact).size());
  EXPECT_EQ(facets(split.contact), facets(whole.contact));
}

TEST_P(Parts, have_the_mass_and_modes_of_the_complete_mesh) {
  const elasticity::Body whole = elasticity::assemble(whole_, materials_, "whole.msh"),
                         body = elasticity::assemble(mesh_, materials_, "split.msh");
  EXPECT_NEAR(body.total_mass, whole.total_mass, 1e-12 * whole.total_mass);
  EXPECT_EQ(body.free_rows, whole.free_rows);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(body.centre[k], whole.centre[k], 1e-12);
  for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(body.inertia[k], whole.inertia[k], 1e-11);
  for (std::size_t i = 0; i < mesh_.node.size(); ++i) {
    if (!owns(mesh_.node[i])) continue;
    const Eigen::Index row = 3 * (mesh_.node[i] - mesh_.first_node), other = 3 * whole_.node[in_whole_[i]];
    EXPECT_LT((body.rigid_load.middleRows(row, 3) - whole.rigid_load.middleRows(other, 3)).norm(), 1e-12);
  }
  const Eigen::VectorXd got = test::dense_eigenvalues(mesh_, body),
                        wanted = test::dense_eigenvalues(whole_, whole);
  ASSERT_EQ(got.size(), wanted.size());
  EXPECT_LT((got - wanted).cwiseAbs().maxCoeff(), 1e-10 * wanted.maxCoeff());
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (int parts : {1, 2, 3, 5}) {
    all.push_back({"tetrahedra", test::block_geo("tet", 2, 0.3), parts});
    all.push_back({"hexahedra", test::block_geo("hex", 2, 0), parts});
  }
  for (int parts : {2, 3}) all.push_back({"cubes", two_cubes(), parts});
  for (const bool binary : {false, true}) all.push_back({"cubes", two_cubes(), 0, binary});
  all.push_back({"tetrahedra", test::block_geo("tet", 2, 0.3), 3, true});
  return all;
}

// The lowest rank at an interface owns its nodes: a fifth of all nodes lie on one.
TEST(Range, of_a_rank_is_its_share_of_the_nodes_and_elements) {
  const SharedFolder folder;
  test::write_both(folder, test::block_geo("tet", 8, 0.3), 2, 0, /*binary=*/true);
  const mesh::GmshSession gmsh;
  const Mesh mesh = test::mesh_of(test::body_of(folder / "split.msh", 2));
  const double share = 1.0 / parallel::size_of(mesh.comm);
  double own = 0;
  for (const auto& block : mesh.own) own += static_cast<double>(std::count(block.begin(), block.end(), 1));
  EXPECT_LT(own, 1.1 * share * static_cast<double>(mesh.total_elements));
  EXPECT_LT(static_cast<double>(mesh.owned_nodes), 1.3 * share * static_cast<double>(mesh.total_nodes));
}

INSTANTIATE_TEST_SUITE_P(Meshes, Parts, testing::ValuesIn(cases()), [](const auto& it) {
  return it.param.name + "_in_" + std::to_string(it.param.parts) + (it.param.binary ? "_binary" : "");
});

}  // namespace parts_test
}  // namespace ricochet
