// SPDX-License-Identifier: BSD-2-Clause
// Small elements in the balls of `refine`. The oracle is the length of the edges that gmsh made.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "src/mesh/read.hpp"
#include "tests/meshes.hpp"

namespace ricochet {
namespace refine_test {

/// A cube of side 1, meshed with tetrahedra of size 0.25.
const std::string cube =
    "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 1, 1, 1};\nPhysical Volume(\"body\") = {1};\n"
    "Mesh.MeshSizeMax = 0.25;\n";

struct Edges {
  double longest_near = 0, shortest_far = std::numeric_limits<double>::infinity();
  std::size_t elements = 0;
};

/// Edges of linear elements, near a point (their middle is within `near`) and far from it (beyond `far`).
Edges edges_of(const scene::Body& body, const std::array<double, 3>& at, double near, double far) {
  const mesh::GmshSession gmsh;
  const mesh::GlobalMesh mesh = mesh::read_mesh(body);
  Edges out;
  for (const auto& block : mesh.blocks) {
    const std::size_t corners = 4;
    out.elements += block.size();
    for (std::size_t e = 0; e < block.node.size(); e += corners)
      for (std::size_t i = 0; i < corners; ++i)
        for (std::size_t j = 0; j < i; ++j) {
          double length = 0, away = 0;
          for (std::size_t k = 0; k < 3; ++k) {
            const double a = mesh.position[3 * static_cast<std::size_t>(block.node[e + i]) + k],
                         b = mesh.position[3 * static_cast<std::size_t>(block.node[e + j]) + k];
            length += (a - b) * (a - b);
            away += ((a + b) / 2 - at[k]) * ((a + b) / 2 - at[k]);
          }
          if (std::sqrt(away) < near) out.longest_near = std::max(out.longest_near, std::sqrt(length));
          if (std::sqrt(away) > far) out.shortest_far = std::min(out.shortest_far, std::sqrt(length));
        }
  }
  return out;
}

// Edges of gmsh are up to about 2.2 times as long, and down to a third as long, as the size that it is asked
// for.
TEST(Refine, makes_elements_small_within_the_ball_and_leaves_those_far_away) {
  const test::SharedFile file(".geo", cube);
  scene::Body body = test::body_of(file.path(), 1);
  const Edges plain = edges_of(body, {0, 0, 1}, 0.1, 0.9);
  body.refine = {{.at = {0, 0, 1}, .radius = 0.1, .size = 0.02}};
  const Edges fine = edges_of(body, {0, 0, 1}, 0.1, 0.9);
  EXPECT_LT(fine.longest_near, 2.5 * 0.02);
  EXPECT_GT(fine.longest_near, 0.02 / 3);
  EXPECT_GT(fine.shortest_far, 0.25 / 3);
  EXPECT_GT(fine.elements, 2 * plain.elements);
  body.refine.clear();
  EXPECT_EQ(edges_of(body, {0, 0, 1}, 0.1, 0.9).elements, plain.elements) << "the next body is refined, too";
}

// The same mesh in millimetres, with the factor that the scene puts on all other sizes.
TEST(Refine, is_in_metres_whatever_the_scale_and_the_size_factor) {
  const test::SharedFile file(".geo", cube);
  scene::Body body = test::body_of(file.path(), 1);
  body.scale = 1e-3;
  body.size_factor = 2;
  body.refine = {{.at = {0, 0, 1e-3}, .radius = 0.1e-3, .size = 0.02e-3}};
  const Edges fine = edges_of(body, {0, 0, 1e-3}, 0.1e-3, 0.9e-3);
  EXPECT_LT(fine.longest_near, 2.5 * 0.02e-3);
  EXPECT_GT(fine.longest_near, 0.02e-3 / 3);
}

TEST(Refine, of_one_body_is_not_that_of_the_next_in_the_same_session) {
  const test::SharedFile file(".geo", cube);
  scene::Body body = test::body_of(file.path(), 1);
  const mesh::GmshSession gmsh;
  const auto nodes = [&] { return mesh::read_mesh(body).fixed.size(); };
  const std::size_t plain = nodes();
  body.refine = {{.at = {0, 0, 1}, .radius = 0.1, .size = 0.02}};
  EXPECT_GT(nodes(), 3 * plain / 2);
  body.refine.clear();
  EXPECT_EQ(nodes(), plain);
}

TEST(Refine, of_two_balls_takes_the_smaller_size) {
  const test::SharedFile file(".geo", cube);
  scene::Body body = test::body_of(file.path(), 1);
  body.refine = {{.at = {0, 0, 1}, .radius = 0.1, .size = 0.02},
                 {.at = {0, 0, 1}, .radius = 0.2, .size = 0.1}};
  EXPECT_LT(edges_of(body, {0, 0, 1}, 0.1, 0.9).longest_near, 2.5 * 0.02);
  std::ranges::reverse(body.refine);
  EXPECT_LT(edges_of(body, {0, 0, 1}, 0.1, 0.9).longest_near, 2.5 * 0.02);
}

}  // namespace refine_test
}  // namespace ricochet
