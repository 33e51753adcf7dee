// SPDX-License-Identifier: BSD-2-Clause
// Files of other programs: their kinds, the order of their nodes, and volumes that belong to no group.
#include <gmock/gmock.h>
#include <gmsh.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "src/elasticity/assemble.hpp"
#include "src/mesh/partition.hpp"
#include "src/mesh/read.hpp"
#include "tests/meshes.hpp"
#include "tests/support.hpp"

namespace ricochet {
namespace foreign_test {

using testing::HasSubstr;

/// Corners 0 to 3 and the middles of the edges in the order of gmsh: 01, 12, 20, 30, 23, 13. The volume is 1.
constexpr std::array<std::array<double, 3>, 10> tetrahedron{{{0, 0, 0},
                                                             {2, 0, 0},
                                                             {0, 3, 0},
                                                             {0, 0, 1},
                                                             {1, 0, 0},
                                                             {1, 1.5, 0},
                                                             {0, 1.5, 0},
                                                             {0, 0, 0.5},
                                                             {0, 1.5, 0.5},
                                                             {1, 0, 0.5}}};

/// A legacy VTK file of one element, with the points in this order.
std::string vtk(const std::vector<int>& order) {
  std::string text = fmt::format(
      "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {} double\n", order.size());
  for (int node : order) {
    const auto& x = tetrahedron[static_cast<std::size_t>(node)];
    text += fmt::format("{} {} {}\n", x[0], x[1], x[2]);
  }
  text += fmt::format("CELLS 1 {}\n{}", order.size() + 1, order.size());
  for (std::size_t k = 0; k < order.size(); ++k) text += fmt::format(" {}", k);
  return text + fmt::format("\nCELL_TYPES 1\n{}\n", order.size() == 4 ? 10 : 24);
}

double volume_of(const scene::Body& body, mesh::GlobalMesh mesh) {
  return elasticity::assemble(mesh::distribute(std::move(mesh), PETSC_COMM_SELF), body.materials, "test")
             .total_mass /
         body.materials[0].density;
}

TEST(Foreign, node_orders_of_other_programs_are_corrected_with_a_warning) {
  const mesh::GmshSession gmsh;
  struct Case {
    std::vector<int> order;
    bool corrected;
  };
  const Case cases[] = {
      {{0, 1, 2, 3}, false},
      {{1, 0, 2, 3}, true},                     // the other orientation
      {{0, 1, 2, 3, 4, 5, 6, 7, 9, 8}, false},  // of VTK
      {{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}, true},   // of gmsh in a file of VTK
      {{0, 2, 1, 3, 6, 5, 4, 7, 8, 9}, true},   // mirrored
      {{0, 1, 2, 3, 9, 8, 7, 6, 5, 4}, true},   // of nobody
  };
  for (const Case& one : cases) {
    const test::SharedFile file(".vtk", vtk(one.order));
    const scene::Body body = test::body_of(file.path(), 1);
    const mesh::GlobalMesh mesh = mesh::read_mesh(body);
    EXPECT_EQ(mesh.order, one.order.size() == 4 ? 1 : 2);
    ASSERT_EQ(mesh.warnings.size(), one.corrected ? 1U : 0U) << testing::PrintToString(one.order);
    if (one.corrected) {
      EXPECT_THAT(mesh.warnings[0], HasSubstr("the nodes of 1 elements were in an order"));
    }
    EXPECT_NEAR(volume_of(body, mesh), 1, 1e-12) << testing::PrintToString(one.order);
  }
}

TEST(Foreign, an_inverted_element_is_not_hidden_by_another_order) {
  const mesh::GmshSession gmsh;
  // Two middles lie at one place, so that no order is right.
  std::string text = vtk({0, 1, 2, 3, 4, 5, 6, 7, 7, 8});
  const test::SharedFile file(".vtk", text);
  const scene::Body body = test::body_of(file.path(), 1);
  const mesh::GlobalMesh mesh = mesh::read_mesh(body);
  EXPECT_TRUE(mesh.warnings.empty());
  EXPECT_THROW(volume_of(body, mesh), InputError);
}

TEST(Foreign, volumes_without_a_group_are_left_out_if_there_are_groups) {
  const mesh::GmshSession gmsh;
  const std::string boxes =
      "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 1, 1, 1};\nBox(2) = {1, 0, 0, 2, 1, "
      "1};\nCoherence;\n";
  const auto read = [](const std::string& text) {
    const test::SharedFile file(".geo", text);
    const scene::Body body = test::body_of(file.path(), 1);
    const mesh::GlobalMesh mesh = mesh::read_mesh(body);
    return std::pair{volume_of(body, mesh), mesh.warnings};
  };
  const auto [first, warnings] = read(boxes + "Physical Volume(\"a\") = {1};\n");
  EXPECT_NEAR(first, 1, 1e-12);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_THAT(warnings[0], HasSubstr("\"volume 2\" of body belongs to no physical group and is left out"));
  for (const char* groups : {"", "Physical Volume(\"a\") = {1};\nPhysical Volume(7) = {2};\n",
                             "Physical Surface(\"s\") = {1};\n"}) {
    const auto [both, none] = read(boxes + groups);
    EXPECT_NEAR(both, 3, 1e-12) << groups;
    EXPECT_TRUE(none.empty()) << groups;
  }
}

TEST(Foreign, kinds_that_gmsh_does_not_read_are_named_before_the_file_is_opened) {
  const mesh::GmshSession gmsh;
  const auto complaint = [](const char* path) -> std::string {
    try {
      mesh::read_mesh(test::body_of(path, 1));
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(
      complaint("/nowhere/part.inp"),
      HasSubstr("part.inp: is a mesh of another program, which gmsh does not read: run ricochet import "
                "mesh /nowhere/part.inp, and name"));
  EXPECT_THAT(complaint("/nowhere/PART.MED"), HasSubstr("is a mesh of another program"));
  EXPECT_THAT(complaint("/nowhere/part.SLDPRT"), HasSubstr("SolidWorks, which gmsh does not read: export"));
  EXPECT_THAT(complaint("/nowhere/part.zip"), HasSubstr("\".zip\" is no kind of mesh or drawing"));
  EXPECT_THAT(complaint("/nowhere/part"), HasSubstr("\"\" is no kind"));
  for (const char* known : {"/nowhere/part.STEP", "/nowhere/part.vtk", "/nowhere/part.igs"})
    EXPECT_THAT(complaint(known), HasSubstr("no such file"));
}

TEST(Foreign, drawings_of_faces_without_a_solid_are_refused_with_the_format_that_keeps_it) {
  const mesh::GmshSession gmsh;
  const auto own = std::filesystem::temp_directory_path() / fmt::format("ricochet-faces-{}.brep", getpid());
  gmsh::model::add("faces");
  gmsh::model::occ::addRectangle(0, 0, 0, 1, 1);
  gmsh::model::occ::synchronize();
  gmsh::write(own.string());
  gmsh::model::remove();
  std::ostringstream text;
  text << std::ifstream(own).rdbuf();
  std::filesystem::remove(own);
  const test::SharedFile file(".brep", text.str());
  try {
    mesh::read_mesh(test::body_of(file.path(), 1));
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("has faces but no solid, and 4 edges of its 1 faces stay free"));
    EXPECT_THAT(error.what(), HasSubstr("export the body as a solid, in .step"));
  }
}

/// A .brep of the faces of a unit cube, each with edges of its own. The last `missing` faces are left out,
/// and the first one is off its place by `gap`.
std::string loose_faces(int missing, double gap) {
  const auto own = std::filesystem::temp_directory_path() / fmt::format("ricochet-loose-{}.brep", getpid());
  gmsh::model::add("loose");
  for (int face = 0; face < 6 - missing; ++face) {
    const int axis = face / 2;
    std::vector<int> points, lines;
    for (const auto& [u, v] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
      double x[3];
      x[axis] = face % 2 - (face == 0 ? gap : 0);
      x[(axis + 1) % 3] = u;
      x[(axis + 2) % 3] = v;
      points.push_back(gmsh::model::occ::addPoint(x[0], x[1], x[2]));
    }
    for (std::size_t k = 0; k < 4; ++k)
      lines.push_back(gmsh::model::occ::addLine(points[k], points[(k + 1) % 4]));
    gmsh::model::occ::addPlaneSurface({gmsh::model::occ::addCurveLoop(lines)});
  }
  gmsh::model::occ::synchronize();
  gmsh::write(own.string());
  gmsh::model::remove();
  std::ostringstream text;
  text << std::ifstream(own).rdbuf();
  std::filesystem::remove(own);
  return text.str();
}

TEST(Foreign, loose_faces_of_a_cube_are_sewn_with_the_smallest_tolerance_that_closes_it) {
  const mesh::GmshSession gmsh;
  // The diagonal of the cube is √3; tolerances grow by factors of 10.
  for (const auto& [gap, tolerance] : {std::pair{0.0, "of 1.7e-09"}, {1e-6, "of 1.7e-06"}}) {
    const test::SharedFile file(".brep", loose_faces(0, gap));
    const scene::Body body = test::body_of(file.path(), 1);
    const mesh::GlobalMesh mesh = mesh::read_mesh(body);
    ASSERT_EQ(mesh.warnings.size(), 1U);
    EXPECT_THAT(mesh.warnings[0], HasSubstr("its 6 loose faces were sewn into a solid with a tolerance "));
    EXPECT_THAT(mesh.warnings[0], HasSubstr(tolerance));
    EXPECT_NEAR(volume_of(body, mesh), 1, 2e-6);  // the gap
  }
}

TEST(Foreign, faces_that_do_not_close_after_sewing_are_refused_with_their_free_edges) {
  const mesh::GmshSession gmsh;
  const auto complaint = [](const std::string& text) {
    const test::SharedFile file(".brep", text);
    return test::complaint_of([&] { mesh::read_mesh(test::body_of(file.path(), 1)); });
  };
  EXPECT_THAT(complaint(loose_faces(1, 0)),
              HasSubstr("has faces but no solid, and 4 edges of its 5 faces stay free"));
  EXPECT_THAT(complaint(loose_faces(0, 1e-3)), HasSubstr("and 8 edges of its 6 faces stay free"));
}

/// The triangles of a box of `edge` around the origin as text of a .stl, without the last `missing` ones.
std::string stl(double edge, std::size_t missing = 0) {
  const auto corner = [&](int k) {
    const double h = edge / 2;
    return fmt::format("vertex {} {} {}\n", (k & 1) != 0 ? h : -h, (k & 2) != 0 ? h : -h,
                       (k & 4) != 0 ? h : -h);
  };
  const std::array<std::array<int, 4>, 6> sides{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  std::vector<std::string> facets;
  for (const auto& [a, b, c, d] : sides)
    for (const auto& [i, j, k] : {std::array{a, b, c}, std::array{a, c, d}})
      facets.push_back("facet normal 0 0 0\nouter loop\n" + corner(i) + corner(j) + corner(k) +
                       "endloop\nendfacet\n");
  facets.resize(facets.size() - missing);
  return fmt::format("solid box\n{}endsolid box\n", fmt::join(facets, ""));
}

TEST(Foreign, the_inside_of_a_closed_surface_is_meshed_without_its_cavities) {
  const mesh::GmshSession gmsh;
  for (const auto& [text, volume] :
       {std::pair{stl(2), 8.0}, std::pair{stl(2) + stl(1), 7.0}, std::pair{stl(1) + stl(2), 7.0}}) {
    const test::SharedFile file(".stl", text);
    scene::Body body = test::body_of(file.path(), 1);
    body.order = 2;
    const mesh::GlobalMesh mesh = mesh::read_mesh(body);
    EXPECT_EQ(mesh.order, 2);
    EXPECT_NEAR(volume_of(body, mesh), volume, 1e-12) << text;
  }
}

TEST(Foreign, surfaces_that_are_not_closed_are_refused_with_the_place_of_the_hole) {
  const mesh::GmshSession gmsh;
  const auto complaint = [](const std::string& text) -> std::string {
    const test::SharedFile file(".stl", text);
    try {
      mesh::read_mesh(test::body_of(file.path(), 1));
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(complaint(stl(2, 1)),
              HasSubstr(".stl: is not a closed surface: 3 of its 18 edges do not belong to "
                        "two triangles, the first at ("));
  EXPECT_THAT(complaint(stl(2) + stl(1, 2)), HasSubstr("4 of its 35 edges"));
  EXPECT_THAT(complaint("solid nothing\nendsolid nothing\n"), HasSubstr(".stl: "));
}

}  // namespace foreign_test
}  // namespace ricochet
