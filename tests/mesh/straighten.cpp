// SPDX-License-Identifier: BSD-2-Clause
// Inverted curved elements: found, and straightened with their neighbours.
#include "src/mesh/straighten.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "src/elasticity/assemble.hpp"
#include "src/mesh/read.hpp"
#include "tests/meshes.hpp"

namespace ricochet {
namespace straighten_test {

/// Two tetrahedra of order 2 that share the face z = 0, with straight edges of length 1 along the axes. Nodes
/// 0 to 4 are the corners (0,0,0), (1,0,0), (0,1,0), (0,0,1) and (0,0,−1).
mesh::GlobalMesh two_tetrahedra() {
  mesh::GlobalMesh mesh;
  mesh.order = 2;
  mesh.position = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1};
  // gmsh's order of edges: 01, 12, 20, 30, 32, 31.
  constexpr int edge[6][2] = {{0, 1}, {1, 2}, {2, 0}, {3, 0}, {3, 2}, {3, 1}};
  mesh::Block block;
  block.gmsh_type = mesh::type_of(mesh::Family::tetrahedron, 2);
  block.nodes_per_element = 10;
  std::map<std::pair<int, int>, std::int64_t> middle;
  for (const std::array<int, 4>& corner : {std::array{0, 1, 2, 3}, std::array{0, 2, 1, 4}}) {
    for (const int c : corner) block.node.push_back(c);
    for (const auto& [a, b] : edge) {
      const std::pair ends =
          std::minmax({corner[static_cast<std::size_t>(a)], corner[static_cast<std::size_t>(b)]});
      const auto next = static_cast<std::int64_t>(mesh.position.size() / 3);
      const auto [at, fresh] = middle.emplace(ends, next);
      if (fresh)
        for (std::size_t k = 0; k < 3; ++k)
          mesh.position.push_back((mesh.position[3 * static_cast<std::size_t>(ends.first) + k] +
                                   mesh.position[3 * static_cast<std::size_t>(ends.second) + k]) /
                                  2);
      block.node.push_back(at->second);
    }
    block.tag.push_back(static_cast<std::int64_t>(block.tag.size()) + 1);
    block.label.push_back(0);
  }
  mesh.blocks = {block};
  return mesh;
}

TEST(Inverted, is_no_straight_and_no_slightly_curved_element) {
  const mesh::GmshSession gmsh;
  mesh::GlobalMesh mesh = two_tetrahedra();
  EXPECT_EQ(mesh::count_inverted(mesh), 0);
  mesh.position[3 * 5 + 1] -= 0.1;  // the middle of the edge from (0,0,0) to (1,0,0)
  EXPECT_EQ(mesh::count_inverted(mesh), 0);
  const std::vector<double> before = mesh.position;
  EXPECT_EQ(mesh::straighten_inverted(mesh).elements, 0);
  EXPECT_EQ(mesh.position, before);
}

// The middle of the edge along z is pulled through the opposite face. Only the upper element has this edge.
TEST(Inverted, is_an_element_with_an_edge_through_its_face_and_it_is_straightened) {
  const mesh::GmshSession gmsh;
  mesh::GlobalMesh mesh = two_tetrahedra();
  const std::vector<double> straight = mesh.position;
  const auto node = static_cast<std::size_t>(mesh.blocks[0].node[7]);  // of the edge 30
  mesh.position[3 * node] += 0.9;
  mesh.position[3 * node + 1] += 0.9;
  EXPECT_EQ(mesh::count_inverted(mesh), 1);
  const mesh::Straightened done = mesh::straighten_inverted(mesh);
  EXPECT_EQ(done.elements, 1);
  EXPECT_DOUBLE_EQ(done.distance, 0.9 * std::numbers::sqrt2);
  EXPECT_EQ(mesh.position, straight);
}

// gmsh inverts some of the large elements along the tube. The mass is that of a torus, 2π² R r² ρ, to the
// error of quadratic elements that are as large as the radius of the tube.
TEST(Geometry, whose_curved_elements_are_inverted_is_repaired_with_a_warning) {
  const mesh::GmshSession gmsh;
  const test::SharedFile file(".geo",
                              "SetFactory(\"OpenCASCADE\");\nTorus(1) = {0, 0, 0, 1, 0.3};\n"
                              "Mesh.MeshSizeMax = 0.6;\nPhysical Volume(\"body\") = {1};\n");
  const scene::Body body = test::body_of(file.path(), 2);
  const mesh::GlobalMesh read = mesh::read_mesh(body);
  ASSERT_EQ(read.warnings.size(), 1u);
  EXPECT_NE(read.warnings[0].find("curved elements were inverted"), std::string::npos) << read.warnings[0];
  EXPECT_EQ(mesh::count_inverted(read), 0);
  const elasticity::Body made = elasticity::assemble(test::mesh_of(body), body.materials, "test");
  const double pi = std::numbers::pi;
  EXPECT_NEAR(made.total_mass / (2 * pi * pi * 0.09 * body.materials[0].density), 1, 0.05);
  // A file without inverted elements has no warning.
  const test::SharedFile block(".geo", test::block_geo("tet", 2, 0.3));
  EXPECT_TRUE(mesh::read_mesh(test::body_of(block.path(), 2)).warnings.empty());
}

}  // namespace straighten_test
}  // namespace ricochet
