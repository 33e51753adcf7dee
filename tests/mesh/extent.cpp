// SPDX-License-Identifier: BSD-2-Clause
// The outline of a body and the dimension of its supports, on any number of ranks.
#include "src/mesh/extent.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "tests/meshes.hpp"

namespace ricochet {
namespace extent_test {

std::set<std::array<long, 3>> rounded(const std::vector<double>& points) {
  std::set<std::array<long, 3>> out;
  for (std::size_t i = 0; i + 2 < points.size(); i += 3)
    out.insert(
        {std::lround(1e6 * points[i]), std::lround(1e6 * points[i + 1]), std::lround(1e6 * points[i + 2])});
  return out;
}

TEST(Outline, of_a_cube_contains_its_corners) {
  const mesh::GmshSession gmsh;
  const test::SharedFile file(".geo", test::block_geo("hex", 2, 0));
  scene::Body body = test::body_of(file.path(), 2);
  const auto points = rounded(mesh::outline_of(test::mesh_of(body)));
  for (const long x : {0, 1000000})
    for (const long y : {0, 1000000})
      for (const long z : {0, 1000000}) EXPECT_TRUE(points.contains({x, y, z}));
  // Each other point is the first of a whole face or edge, in the direction of one of the six axes.
  EXPECT_LE(points.size(), 8U + 6U);
}

TEST(Outline, of_a_ball_covers_it_within_one_per_cent) {
  const mesh::GmshSession gmsh;
  const test::SharedFile file(
      ".geo",
      "SetFactory(\"OpenCASCADE\");\nSphere(1) = {0, 0, 0, 1};\nPhysical Volume(\"body\") "
      "= {1};\nPhysical Surface(\"top\") = {1};\nMesh.MeshSizeMax = 0.25;\n");
  scene::Body body = test::body_of(file.path(), 2);
  body.contact = {"top"};
  const std::vector<double> points = mesh::outline_of(test::mesh_of(body));
  const std::array<std::array<double, 3>, 3> directions{
      {{0.6, 0.8, 0}, {0.48, 0.64, 0.6}, {-0.28, 0.6, -0.7493}}};
  for (const auto& n : directions) {
    double farthest = 0;
    for (std::size_t i = 0; i < points.size(); i += 3)
      farthest = std::max(farthest, n[0] * points[i] + n[1] * points[i + 1] + n[2] * points[i + 2]);
    EXPECT_GT(farthest, 0.98);  // 0.01 of the lattice, and 0.01 of the mesh
    EXPECT_LE(farthest, 1 + 1e-4);
  }
}

TEST(Surface, of_a_block_is_that_of_its_faces_on_any_number_of_ranks) {
  const mesh::GmshSession gmsh;
  for (const char* kind : {"tet", "hex"}) {
    const test::SharedFile file(".geo", test::block_geo(kind, 3, 0));
    for (const int order : {1, 2}) {
      const scene::Body body = test::body_of(file.path(), order);
      EXPECT_NEAR(mesh::surface_of(test::mesh_of(body)), 6, 1e-12) << kind << order;
    }
  }
}

std::int64_t fixed_on_lines(const std::map<std::string, std::string>& support) {
  const mesh::GmshSession gmsh;
  std::string geo = test::block_geo("tet", 2, 0);
  geo += "Physical Curve(\"edge\") = {1};\nPhysical Point(\"corner\") = {8};\n";
  const test::SharedFile file(".geo", geo);
  scene::Body body = test::body_of(file.path(), 1);
  body.support = support;
  return mesh::held_on_lines(test::mesh_of(body));
}

TEST(Supports, on_lines_and_points_of_solids_are_found_by_component) {
  EXPECT_EQ(fixed_on_lines({}), 0);
  EXPECT_EQ(fixed_on_lines({{"bottom", "xyz"}}), 0);
  EXPECT_EQ(fixed_on_lines({{"edge", "xyz"}}), 7);
  EXPECT_EQ(fixed_on_lines({{"corner", "z"}}), 4);
  EXPECT_EQ(fixed_on_lines({{"bottom", "xy"}, {"corner", "z"}}), 4);
  EXPECT_EQ(fixed_on_lines({{"bottom", "xyz"}, {"edge", "x"}}), 0);  // a surface holds x as well
}

}  // namespace extent_test
}  // namespace ricochet
