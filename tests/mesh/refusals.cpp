// SPDX-License-Identifier: BSD-2-Clause
// Unusable input is refused on every rank, in one line that states the place, the fault and the remedy.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "src/elasticity/assemble.hpp"
#include "src/mesh/open.hpp"
#include "tests/mesh/files.hpp"
#include "tests/meshes.hpp"

namespace ricochet {
namespace refusals_test {

using testing::AllOf;
using testing::HasSubstr;

/// The error of a body between its file and its matrices. It must be the same
/// on every rank; otherwise "ranks differ".
std::string complaint(const scene::Body& body) {
  std::string said = "accepted";
  try {
    const mesh::GmshSession gmsh;
    elasticity::assemble(test::mesh_of(body), body.materials, body.mesh.filename().string());
  } catch (const InputError& error) {
    said = error.what();
  }
  std::string first = said;
  parallel::broadcast(PETSC_COMM_WORLD, first);
  const std::int64_t same = parallel::sum(PETSC_COMM_WORLD, std::int64_t{first == said});
  return same == parallel::size_of(PETSC_COMM_WORLD) ? said : "ranks differ";
}

/// One line that starts with the name of the file.
auto about(const test::SharedFile& file) {
  return AllOf(testing::StartsWith(file.path().filename().string() + ": "), testing::Not(HasSubstr("\n")));
}

std::string complaint(const test::SharedFile& file, int order = 1) {
  return complaint(test::body_of(file.path(), order));
}

TEST(Refusal, a_missing_file_is_named) {
  for (const char* path : {"/nowhere/part.msh", "/nowhere/part.geo", "/nowhere/part.step"}) {
    const std::string said = complaint(test::body_of(path, 1));
    EXPECT_THAT(said, AllOf(HasSubstr("no such file"), HasSubstr("bodies.body.mesh"), HasSubstr(path)));
  }
}

TEST(Refusal, a_missing_group_is_named_with_the_available_ones) {
  const test::SharedFile file(".geo", test::block_geo("hex", 1, 0));
  scene::Body body = test::body_of(file.path(), 1);
  body.contact = {"rim"};
  EXPECT_THAT(complaint(body),
              AllOf(about(file), HasSubstr("no physical surface \"rim\""),
                    HasSubstr("\"bottom\", \"sides\", \"top\""), HasSubstr("bodies.body.contact")));
  body.contact = {"top"};
  body.support = {{"rim", "xyz"}};
  EXPECT_THAT(complaint(body), AllOf(about(file), HasSubstr("\"rim\""), HasSubstr("bodies.body.support")));
  body.support.clear();
  body.materials[0].group = "steel";
  EXPECT_THAT(complaint(body),
              AllOf(about(file), HasSubstr("no physical volume \"steel\": the groups are \"body\""),
                    HasSubstr("bodies.body.material")));
  body.materials[0].group = "body";
  EXPECT_EQ(complaint(body), "accepted");
}

TEST(Refusal, inverted_elements_are_named_with_their_position) {
  // The corners of the second tetrahedron have the wrong orientation.
  for (const std::string& text : {test::two_tetrahedra_22("1 2 3 5"), test::two_tetrahedra_41("1 2 3 5")}) {
    const test::SharedFile file(".msh", text);
    EXPECT_THAT(complaint(file), AllOf(about(file), HasSubstr("element 2 near (0, 0, 0) m is inverted")));
  }
  for (const std::string& text : {test::two_tetrahedra_22("1 3 2 5"), test::two_tetrahedra_41("1 3 2 5")}) {
    const test::SharedFile file(".msh", text);
    EXPECT_EQ(complaint(file), "accepted");
  }
}

TEST(Refusal, a_hexahedron_numbered_row_by_row_is_inverted) {
  const test::SharedFile good(".msh", test::one_hexahedron("1 2 3 4 5 6 7 8"));
  EXPECT_EQ(complaint(good), "accepted");
  for (const char* order : {"1 2 4 3 5 6 8 7", "5 6 7 8 1 2 3 4", "1 4 3 2 5 8 7 6"}) {
    const test::SharedFile file(".msh", test::one_hexahedron(order));
    EXPECT_THAT(complaint(file), AllOf(about(file), HasSubstr("element 1"), HasSubstr("inverted"))) << order;
  }
}

TEST(Refusal, an_unknown_parameter_is_named_with_the_available_ones) {
  const std::string body_of_it =
      "Point(1) = {0,0,0};\nPoint(2) = {length,0,0};\nLine(1) = {1,2};\nTransfinite Curve{1} = n + 1;\n";
  const test::SharedFile file(".geo",
                              "// DefineConstant[ commented = 1 ];\n"
                              "DefineConstant[ length = {2, Min 1, Max 3, Name \"a, b] = {\"}, n = {4, Name "
                              "\"n\", Choices{4 = \"few, n\", 8 = "
                              "\"many\"}} /* , ghost = 1 */ ];\n"
                              "If(!Exists(extra)) extra = 0; EndIf\n" +
                                  body_of_it);
  scene::Body body = test::body_of(file.path(), 1);
  body.geometry = {{"lenght", 3}};
  EXPECT_THAT(complaint(body), AllOf(about(file), HasSubstr("bodies.body.geometry.lenght = 3"),
                                     HasSubstr("it defines extra, length, n.")));
  body.geometry = {{"length", 3}, {"n", 8}, {"extra", 1}};
  EXPECT_EQ(complaint(body), "accepted");

  const test::SharedFile outer(".geo", fmt::format("Include \"{}\";\n", file.path().filename().string()));
  body = test::body_of(outer.path(), 1);
  body.geometry = {{"length", 3}};
  EXPECT_EQ(complaint(body), "accepted");
  body.geometry = {{"height", 3}};
  EXPECT_THAT(complaint(body), AllOf(about(outer), HasSubstr("it defines extra, length, n.")));

  // Neither a file that includes itself nor very many spaces cause an endless loop.
  const test::SharedFile odd(".geo", "Include" + std::string(1 << 20, ' ') + "\"none.geo\"\nDefineConstant" +
                                         std::string(1 << 20, ' ') + "[ length = 2 ];\n");
  const std::string itself = fmt::format("Include \"{}\"\n", odd.path().filename().string());
  parallel::on_first_rank(PETSC_COMM_WORLD,
                          [&] { std::ofstream(odd.path(), std::ios::app) << itself << itself; });
  EXPECT_EQ(mesh::parameters_of(odd.path()), std::set<std::string>{"length"});

  const test::SharedFile plain(".geo", "length = 2;\nn = 3;\n" + body_of_it);
  body = test::body_of(plain.path(), 1);
  body.geometry = {{"length", 3}};
  EXPECT_THAT(complaint(body), AllOf(about(plain), HasSubstr("it defines none")));

  const test::SharedFile mesh(".msh", test::one_hexahedron("1 2 3 4 5 6 7 8"));
  body = test::body_of(mesh.path(), 1);
  body.geometry = {{"length", 3}};
  EXPECT_THAT(complaint(body), AllOf(about(mesh), HasSubstr("only a .geo has parameters")));
}

TEST(Refusal, a_file_that_is_not_a_complete_mesh_is_refused) {
  for (const std::string& text : {std::string(), std::string("this is not a mesh\n"),
                                  std::string("\x7f\0\x01ELF\nbinary", 12), std::string("$")}) {
    const test::SharedFile file(".msh", text);
    EXPECT_THAT(complaint(file), about(file)) << text;
  }
  for (const std::string& whole : {test::two_tetrahedra_22("1 3 2 5"), test::two_tetrahedra_41("1 3 2 5")}) {
    // The file is truncated anywhere: within a header, within a number, at the end of a section.
    for (std::size_t length = 1; length + 13 < whole.size(); length += 7) {
      const test::SharedFile file(".msh", whole.substr(0, length));
      EXPECT_THAT(complaint(file), about(file)) << whole.substr(0, length);
    }
  }
  const test::SharedFile broken(".msh", test::one_hexahedron("1 2 3 4 5 6 7 99"));
  EXPECT_THAT(complaint(broken), AllOf(about(broken), HasSubstr("99")));
}

// Files for which gmsh 4.8 exhausts memory, crashes, or silently reads something else.
TEST(Refusal, a_mesh_file_that_gmsh_cannot_be_trusted_with_is_refused_before) {
  const std::string old = test::two_tetrahedra_22("1 3 2 5"), now = test::two_tetrahedra_41("1 3 2 5");
  struct Change {
    std::string whole, from, to, said;
  };
  for (const auto& [whole, from, to, said] :
       {Change{now, "4.1 0", "3.0 0", "line 2: has an unsupported version"},
        Change{now, "0 0 0 1\n", "0 0 0 4000000000000\n", "the number of entities is 4000000000000"},
        Change{now, "1 5 1 5", "1 4000000000 1 5", "the number of nodes differs"},
        Change{now, "3 1 0 5", "3 1 0 5000", "the number of nodes differs"},
        Change{now, "\n4\n5\n", "\n4\n6\n", "a node's tag is 6: must be from 1 to 5"},
        Change{now, "1 2 1 2", "1 4000000000 1 2", "the number of elements differs"},
        Change{now, "\n2\n3\n", "\n2\n2\n", "node 2 occurs twice"},
        Change{now, "\n1 0 0\n", "\n1 nan 0\n", "a coordinate is not finite"},
        Change{now, "3 1 4 2", "2 1 4 2", "differ in dimension"},
        Change{now, "3 1 4 2", "3 1 35 2", "elements of type 35 are not supported"},
        Change{now, "$Nodes\n", "$GhostElements\n0\n$EndGhostElements\n$Nodes\n",
               "without results and ghost cells"},
        Change{now, "$Nodes\n", "$Entities\n0 0 0 0\n$EndEntities\n$Nodes\n",
               "the second section of its kind"},
        Change{old, "1 4 2 1 1", "1 4 4 1 1 1 2000000000",
               "partition is not from 1 to the number of elements"},
        Change{old, "1 4 2 1 1", "1 4 5 1 1 1 1 77", "or a parent"},
        Change{old, "1 4 2 1 1", "1 34 2 1 1 200000000", "elements of type 34 are not supported"},
        Change{old, "$Elements\n", "$Periodic\n1\n2 1 1\n1234567\n$EndPeriodic\n$Elements\n",
               "must be below 100000"}}) {
    std::string text = whole;
    ASSERT_NE(text.find(from), std::string::npos) << from;
    const test::SharedFile file(".msh", text.replace(text.find(from), from.size(), to));
    EXPECT_THAT(complaint(file), AllOf(about(file), HasSubstr(said))) << to;
  }
}

TEST(Refusal, surfaces_without_a_volume_and_mixed_orders_are_refused) {
  const test::SharedFile surface(".msh", test::one_element(3, "1 2 3 4"));
  EXPECT_THAT(complaint(surface), AllOf(about(surface), HasSubstr("surface elements but no volume")));
  const test::SharedFile pyramid(".msh", test::one_element(7, "1 2 3 4 5"));
  EXPECT_THAT(complaint(pyramid), AllOf(about(pyramid), HasSubstr("\"Pyramid 5\" are not supported")));
  // In one volume, where gmsh itself loses the second element, and in two volumes.
  for (int volume : {1, 2}) {
    const test::SharedFile mixed(".msh", test::tetrahedra_of_two_orders(volume));
    EXPECT_THAT(complaint(mixed), AllOf(about(mixed), HasSubstr("mixes element orders"))) << volume;
  }
}

TEST(Refusal, contact_all_stands_alone_and_is_not_for_rods) {
  const test::SharedFile file(".geo", test::block_geo("hex", 1, 0)), rod(".geo", test::rod_geo(2));
  scene::Body body = test::body_of(file.path(), 1);
  body.contact = {"top", "all"};
  EXPECT_THAT(complaint(body),
              AllOf(about(file), HasSubstr("bodies.body.contact: \"all\" is the whole surface of the body: "
                                           "name it alone")));
  body.mesh = rod.path();
  body.contact = {"all"};
  EXPECT_THAT(complaint(body), AllOf(about(rod), HasSubstr("no physical point \"all\": the groups are "
                                                           "\"left\", \"right\"")));
}

TEST(Refusal, groups_that_overlap_or_lie_elsewhere_are_refused) {
  const test::SharedFile file(".geo",
                              test::block_geo("hex", 1, 0) +
                                  "Physical Volume(\"again\") = {1};\nPhysical Surface(\"all\") = {1:6};\n");
  scene::Body body = test::body_of(file.path(), 1);
  body.contact = {"top", "all"};
  EXPECT_THAT(complaint(body), AllOf(about(file), HasSubstr("lies in two groups of bodies.body.contact")));
  body.contact = {"top"};
  body.materials.push_back(body.materials[0]);
  body.materials[0].group = "body";
  body.materials[1].group = "again";
  EXPECT_THAT(complaint(body), AllOf(about(file), HasSubstr("lies in two groups of bodies.body.material")));

  // Two separate cubes, of which the first is the body.
  const test::SharedFile two(
      ".geo",
      "SetFactory(\"OpenCASCADE\");\nBox(1) = {0,0,0,1,1,1};\nBox(2) = {3,0,0,1,1,1};\n"
      "Physical Volume(\"body\") = {1};\nPhysical Volume(\"other\") = {2};\n"
      "Physical Surface(\"far\") = {12};\n");
  body = test::body_of(two.path(), 1);
  body.materials[0].group = "body";
  EXPECT_EQ(complaint(body), "accepted");
  body.contact = {"far"};
  EXPECT_THAT(complaint(body), AllOf(about(two), HasSubstr("not on the body's surface")));
  body.contact.clear();
  body.support = {{"far", "xyz"}};
  EXPECT_THAT(complaint(body),
              AllOf(about(two), HasSubstr("bodies.body.support.far holds no node of the body")));
}

TEST(Refusal, rods_are_straight_chains_that_touch_at_their_ends) {
  const auto chain = [](const char* third) {
    return fmt::format(
        "Point(1) = {{0,0,0}};\nPoint(2) = {{1,0,0}};\nPoint(3) = {};\nLine(1) = {{1,2}};\nLine(2) = "
        "{{2,3}};\n"
        "Transfinite Curve{{1,2}} = 3;\nPhysical Point(\"end\") = {{1}};\nPhysical Point(\"middle\") = "
        "{{2}};\n",
        third);
  };
  const test::SharedFile bent(".geo", chain("{2,0.1,0}")), straight(".geo", chain("{2,0,0}"));
  EXPECT_THAT(complaint(bent), AllOf(about(bent), HasSubstr("must be straight")));
  const test::SharedFile star(".geo", chain("{2,0,0}") + "Point(4) = {1,1,0};\nLine(3) = {2,4};\n");
  EXPECT_THAT(complaint(star), AllOf(about(star), HasSubstr("3 ends")));
  scene::Body body = test::body_of(straight.path(), 1);
  body.contact = {"end"};
  EXPECT_EQ(complaint(body), "accepted");
  body.contact = {"middle"};
  EXPECT_THAT(complaint(body), AllOf(about(straight), HasSubstr("not an end of the rod")));
  body.contact.clear();
  body.materials[0].area = 0;
  EXPECT_THAT(complaint(body), AllOf(about(straight), HasSubstr("area = ")));
}

TEST(Refusal, a_line_without_length_is_named) {
  const test::SharedFile flat(".geo", R"(
Point(1) = {0, 0, 0}; Point(2) = {0, 0, 0}; Point(3) = {0, 1, 0}; Point(4) = {0, 1, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Transfinite Curve{1 : 4} = 2;
Curve Loop(1) = {1 : 4}; Plane Surface(1) = {1}; Transfinite Surface{1}; Recombine Surface{1};
body[] = Extrude {0, 0, 1} { Surface{1}; Layers{1}; Recombine; };
Physical Volume("body") = {body[1]};
)");
  EXPECT_THAT(complaint(flat), AllOf(about(flat), HasSubstr("has no length"), HasSubstr("geometry")));
}

// This test is the last, because after a syntax error the parser of gmsh
// is unusable for the rest of the process.
TEST(Refusal, a_geometry_that_gmsh_cannot_read_or_mesh_is_refused) {
  const test::SharedFile syntax(".geo", "Point(1) = {0, 0, 0};\nBlub(3) = {4};\n");
  EXPECT_THAT(complaint(syntax), AllOf(about(syntax), HasSubstr("line 2: syntax error")));
  const test::SharedFile empty(".geo", "");
  EXPECT_THAT(complaint(empty), AllOf(about(empty), HasSubstr("no volume or line elements")));
  const test::SharedFile step(".step", "ISO-10303-21;\nnonsense\n");
  EXPECT_THAT(complaint(step), AllOf(about(step), HasSubstr("export it again")));
}

}  // namespace refusals_test
}  // namespace ricochet
