// SPDX-License-Identifier: BSD-2-Clause
// Pieces of bodies of cubes, counted by eye, on any number of ranks.
#include "src/mesh/pieces.hpp"

#include <gtest/gtest.h>

#include "tests/cubes.hpp"
#include "tests/meshes.hpp"

namespace ricochet {
namespace pieces_test {

struct Found {
  std::int64_t parts;
  std::vector<mesh::Piece> pieces;
  std::int64_t joints;  ///< over all ranks
};

Found found_in(const std::vector<std::array<int, 3>>& cubes, int order = 1) {
  const mesh::GmshSession gmsh;
  const test::SharedFile file(".geo", test::cubes_geo(cubes, 2));
  const mesh::Mesh mesh = test::mesh_of(test::body_of(file.path(), order));
  EXPECT_EQ(mesh.piece.empty(), std::ssize(mesh.pieces) <= mesh.parts);
  return {mesh.parts, mesh.pieces, parallel::sum(mesh.comm, static_cast<std::int64_t>(mesh.joint.size()))};
}

TEST(Pieces, of_cubes_that_meet_at_faces_are_not_listed) {
  const Found found = found_in({{0, 0, 0}, {1, 0, 0}});
  EXPECT_EQ(found.parts, 1);
  EXPECT_TRUE(found.pieces.empty());
}

TEST(Pieces, of_cubes_that_meet_at_an_edge_are_two) {
  const Found found = found_in({{0, 0, 0}, {1, 1, 0}}, 2);
  EXPECT_EQ(found.parts, 1);
  EXPECT_EQ(found.joints, 5);  // two elements of order 2 along the edge
  ASSERT_EQ(found.pieces.size(), 2U);
  for (const mesh::Piece& piece : found.pieces) {
    EXPECT_EQ(piece.part, 0);
    EXPECT_EQ(piece.elements, 8);
    const double x = piece.box[0] < 0.5 ? 0 : 1;
    const std::array<double, 6> box{x, x, 0, x + 1, x + 1, 1};
    for (std::size_t c = 0; c < 6; ++c) EXPECT_NEAR(piece.box[c], box[c], 1e-12) << c;
  }
  EXPECT_GT(std::abs(found.pieces[0].box[0] - found.pieces[1].box[0]), 0.5);
}

TEST(Pieces, of_a_chain_of_corners_beside_a_cube_belong_to_their_parts) {
  const Found found = found_in({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {5, 0, 0}});
  EXPECT_EQ(found.parts, 2);
  EXPECT_EQ(found.joints, 2);
  ASSERT_EQ(found.pieces.size(), 4U);
  std::array<int, 2> of_part{};
  for (const mesh::Piece& piece : found.pieces) ++of_part.at(static_cast<std::size_t>(piece.part));
  EXPECT_EQ(std::max(of_part[0], of_part[1]), 3);
}

// The lower cubes meet at an edge, and the three upper ones lead from one to the other by faces.
TEST(Pieces, that_a_way_around_their_edge_joins_at_faces_are_one) {
  const Found found = found_in({{0, 0, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}});
  EXPECT_EQ(found.parts, 1);
  EXPECT_TRUE(found.pieces.empty());
}

TEST(Pieces, of_cubes_apart_are_their_parts) {
  const Found found = found_in({{0, 0, 0}, {3, 0, 0}});
  EXPECT_EQ(found.parts, 2);
  EXPECT_EQ(found.joints, 0);
  ASSERT_EQ(found.pieces.size(), 2U);
  for (std::int64_t p = 0; p < 2; ++p) {
    EXPECT_EQ(found.pieces[static_cast<std::size_t>(p)].part, p);
    EXPECT_EQ(found.pieces[static_cast<std::size_t>(p)].elements, 8);
  }
}

}  // namespace pieces_test
}  // namespace ricochet
