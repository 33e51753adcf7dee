// SPDX-License-Identifier: BSD-2-Clause
// Errors in meshes that are split into several files, equal on every rank, and the order of these files.
#include <gmock/gmock.h>

#include <set>

#include "src/scene/parts.hpp"
#include "src/scene/request.hpp"
#include "src/scene/scene.hpp"
#include "tests/mesh/files.hpp"
#include "tests/mesh/split.hpp"
#include "tests/meshes.hpp"

namespace ricochet {
namespace split_refused_test {

using test::SharedFolder;
using testing::AllOf;
using testing::HasSubstr;

/// The error of a body in parts. It must be the same on every rank; otherwise "ranks differ".
std::string complaint(const scene::Body& body) {
  std::string said = "accepted";
  try {
    const mesh::GmshSession gmsh;
    test::mesh_of(body);
  } catch (const InputError& error) {
    said = error.what();
  }
  std::string first = said;
  parallel::broadcast(PETSC_COMM_WORLD, first);
  const std::int64_t same = parallel::sum(PETSC_COMM_WORLD, std::int64_t{first == said});
  return same == parallel::size_of(PETSC_COMM_WORLD) ? said : "ranks differ";
}

auto about(const std::string& file) {
  return AllOf(testing::StartsWith(file + ": "), testing::Not(HasSubstr("\n")));
}

class PartsRefused : public testing::Test {
 protected:
  PartsRefused() {
    test::write_both(folder_, test::block_geo("tet", 2, 0), 1, 3);
    body_ = test::body_of(folder_ / "split.msh", 1);
  }
  SharedFolder folder_;
  scene::Body body_;
};

TEST_F(PartsRefused, with_one_missing_between_others) {
  EXPECT_EQ(complaint(body_), "accepted");
  folder_.once([&] { std::filesystem::remove(folder_ / "split_2.msh"); });
  EXPECT_THAT(complaint(body_),
              AllOf(about("split_2.msh"), HasSubstr("no such file"), HasSubstr("split_3.msh")));
}

TEST_F(PartsRefused, with_the_last_missing) {
  folder_.once([&] { std::filesystem::remove(folder_ / "split_3.msh"); });
  EXPECT_THAT(complaint(body_),
              AllOf(HasSubstr("touches part 3"), HasSubstr("only 2"), Not(HasSubstr("\n"))));
}

TEST_F(PartsRefused, with_one_cut_off) {
  folder_.once([&] {
    std::filesystem::resize_file(folder_ / "split_3.msh",
                                 std::filesystem::file_size(folder_ / "split_3.msh") / 2);
  });
  EXPECT_THAT(complaint(body_), AllOf(about("split_3.msh"), HasSubstr("cut off")));
}

TEST_F(PartsRefused, with_one_twice) {
  folder_.once([&] {
    std::filesystem::copy_file(folder_ / "split_1.msh", folder_ / "split_3.msh",
                               std::filesystem::copy_options::overwrite_existing);
  });
  EXPECT_THAT(complaint(body_), AllOf(about("split.msh"), HasSubstr("is in more than one")));
}

/// A file with one tetrahedron in volume 1, and facet 9 named "between" where
/// two tetrahedra meet. Node 1 lies at `x`.
std::string one_cell(const std::string& x, const std::string& tag_and_nodes) {
  return fmt::format(
      "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 9 \"between\"\n$EndPhysicalNames\n"
      "$Entities\n0 1 1 1\n1 0 0 -1 1 1 1 0 0\n9 0 0 -1 1 1 1 1 9 0\n1 0 0 -1 1 1 1 0 0\n$EndEntities\n"
      "$Nodes\n1 5 1 5\n3 1 0 5\n1\n2\n3\n4\n5\n{} 0 0\n1 0 0\n0 1 0\n0 0 1\n0 0 -1\n$EndNodes\n"
      "$Elements\n2 2 1 9\n2 9 2 1\n9 1 2 3\n3 1 4 1\n{}\n$EndElements\n",
      x, tag_and_nodes);
}

TEST(PartsByHand, must_fit_together) {
  const SharedFolder folder;
  scene::Body body = test::body_of(folder / "hand.msh", 1);
  folder.write("hand_1.msh", one_cell("0", "1 1 2 3 4"));
  folder.write("hand_2.msh", one_cell("0", "2 1 3 2 5"));
  EXPECT_EQ(complaint(body), "accepted");
  // The interface between parts does not belong to the surface of the body.
  body.contact = {"between"};
  EXPECT_THAT(complaint(body),
              AllOf(about("hand.msh"), HasSubstr("facet 9"), HasSubstr("is not on the body's surface")));
  body.contact = {"all", "between"};
  EXPECT_THAT(complaint(body), AllOf(about("hand.msh"), HasSubstr("name it alone")));
  body.contact.clear();
  folder.write("hand_2.msh", one_cell("0.1", "2 1 3 2 5"));
  EXPECT_THAT(complaint(body), AllOf(about("hand.msh"), HasSubstr("node 1 lies in different places")));
  folder.write("hand_2.msh", one_cell("0", "1 1 3 2 5"));
  EXPECT_THAT(complaint(body), AllOf(about("hand.msh"), HasSubstr("element 1 is in more than one")));
  folder.write("hand_2.msh", test::two_tetrahedra_22("1 3 2 5"));
  EXPECT_THAT(complaint(body), AllOf(about("hand_2.msh"), HasSubstr("version 2.2")));
}

TEST(PartsByHand, may_not_be_rods) {
  const SharedFolder folder;
  const std::string rod =
      "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 1 0 0\n1 0 0 0 1 0 0 0 0\n$EndEntities\n"
      "$Nodes\n1 2 1 2\n1 1 0 2\n1\n2\n0 0 0\n1 0 0\n$EndNodes\n"
      "$Elements\n1 1 1 1\n1 1 1 1\n1 1 2\n$EndElements\n";
  folder.write("rod_1.msh", rod);
  folder.write("rod_2.msh", rod);
  EXPECT_THAT(complaint(test::body_of(folder / "rod.msh", 1)),
              AllOf(about("rod_1.msh"), HasSubstr("one file")));
}

TEST(PartFiles, are_found_in_the_order_of_their_numbers) {
  const SharedFolder folder;
  EXPECT_TRUE(scene::part_files(folder / "disk.msh").empty());
  for (int part = 1; part <= 11; ++part) folder.write(fmt::format("disk_{}.msh", part), "");
  for (const char* other : {"disk_x.msh", "disk_12.geo", "disk_013.msh", "disk_.msh", "adisk_14.msh"})
    folder.write(other, "");
  const auto files = scene::part_files(folder / "disk.msh");
  ASSERT_EQ(files.size(), 11U);
  for (std::size_t i = 0; i < files.size(); ++i)
    EXPECT_EQ(files[i], folder / fmt::format("disk_{}.msh", i + 1));
  EXPECT_TRUE(scene::part_files(folder / "disk.geo").empty());
  folder.write("disk.msh", "");
  EXPECT_TRUE(scene::part_files(folder / "disk.msh").empty());
}

TEST(PartFiles, all_count_in_the_hash_of_a_kernel) {
  const SharedFolder folder;
  scene::Scene scene;
  scene.bodies = {test::body_of(folder / "disk.msh", 1)};
  const auto hash = [&] { return scene::kernel_request(scene, scene.bodies[0]).hash; };
  EXPECT_THROW(hash(), InputError);
  std::set<std::string> hashes;
  for (const auto& [part, text] :
       {std::pair{"disk_1.msh", "a"}, {"disk_2.msh", "b"}, {"disk_1.msh", "b"}, {"disk_2.msh", "a"}}) {
    folder.write(part, text);
    EXPECT_TRUE(hashes.insert(hash()).second) << part;
  }
}

}  // namespace split_refused_test
}  // namespace ricochet
