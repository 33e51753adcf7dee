// SPDX-License-Identifier: BSD-2-Clause
// Meshes after reading: sizes, measures and orientation compared with closed forms.
#include <fmt/format.h>
#include <gmsh.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <set>

#include "src/mesh/mesh.hpp"
#include "src/mesh/read.hpp"
#include "tests/meshes.hpp"

namespace ricochet {
namespace read_test {

using mesh::GlobalMesh;
using Point = Eigen::Vector3d;

Point at(const GlobalMesh& mesh, std::int64_t node) {
  return Point(&mesh.position[3 * static_cast<std::size_t>(node)]);
}

std::size_t elements_of(const std::vector<mesh::Block>& blocks) {
  std::size_t count = 0;
  for (const mesh::Block& block : blocks) count += block.size();
  return count;
}

/// V = ∫ det J dξ.
double volume_of(const GlobalMesh& mesh) {
  double volume = 0;
  for (const mesh::Block& block : mesh.blocks) {
    const auto element = mesh::reference_element(block.gmsh_type);
    const auto rule = mesh::quadrature_of(element.family, 3 * element.order);
    const auto basis = mesh::basis_at(element, rule.local);
    for (std::size_t e = 0; e < block.size(); ++e)
      for (std::size_t q = 0; q < rule.size(); ++q) {
        Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();
        for (int a = 0; a < element.nodes; ++a)
          jacobian += at(mesh, block.node[e * element.nodes + a]) *
                      Eigen::Map<const Eigen::RowVector3d>(&basis.gradient[3 * (q * element.nodes + a)]);
        volume += jacobian.determinant() * rule.weight[q];
      }
  }
  return volume;
}

/// ∫ n ds, ⅓ ∫ x·n ds and the area of the facets with one label.
struct Flux {
  Point normal = Point::Zero();
  double area = 0, third = 0;
};
Flux flux_of(const GlobalMesh& mesh, std::int64_t label) {
  Flux flux;
  for (const mesh::Block& block : mesh.contact.blocks) {
    const auto facet = mesh::reference_element(block.gmsh_type);
    const auto rule = mesh::quadrature_of(facet.family, 4 * facet.order);
    const auto basis = mesh::basis_at(facet, rule.local);
    for (std::size_t e = 0; e < block.size(); ++e) {
      if (block.label[e] != label) continue;
      for (std::size_t q = 0; q < rule.size(); ++q) {
        Point x = Point::Zero(), u = x, v = x;
        for (int a = 0; a < facet.nodes; ++a) {
          const Point node = at(mesh, block.node[e * facet.nodes + a]);
          x += basis.value[q * facet.nodes + a] * node;
          u += basis.gradient[3 * (q * facet.nodes + a)] * node;
          v += basis.gradient[3 * (q * facet.nodes + a) + 1] * node;
        }
        const Point n = rule.weight[q] * u.cross(v);
        flux.normal += n;
        flux.area += n.norm();
        flux.third += x.dot(n) / 3;
      }
    }
  }
  return flux;
}

/// V from flat triangles of the visualisation surface. It is correct only if all triangles face outward.
double enclosed_by(const GlobalMesh& mesh, const mesh::Block& triangles) {
  double volume = 0;
  const auto& node = triangles.node;
  for (std::size_t t = 0; t < node.size(); t += 3)
    volume += at(mesh, node[t]).dot(at(mesh, node[t + 1]).cross(at(mesh, node[t + 2]))) / 6;
  return volume;
}

TEST(Read, truncated_pyramids_have_their_volume_and_areas_in_every_element_and_order) {
  const mesh::GmshSession gmsh;
  const double lean = 0.4, top = 1 - lean, volume = (1 + top + top * top) / 3;
  const double side = (1 + top) / 2 * std::hypot(1, lean / 2);
  for (const char* kind : {"tet", "hex", "prism"})
    for (int order = 1; order <= 3; ++order) {
      const bool prism = kind == std::string("prism");
      // Contact facets point out of the body even if a geometry asks gmsh to reverse surfaces.
      const test::SharedFile file(".geo", (prism ? test::prism_geo(2) : test::block_geo(kind, 2, lean)) +
                                              "ReverseMesh Surface{1, 3};\n");
      scene::Body body = test::body_of(file.path(), order);
      body.contact = {"bottom", "top", "sides"};
      body.scale = 0.5;
      const GlobalMesh mesh = mesh::read_mesh(body);
      EXPECT_EQ(mesh.order, order);
      const double exact = prism ? 1 : volume;
      EXPECT_NEAR(volume_of(mesh), exact / 8, 1e-13) << kind << order;
      EXPECT_EQ(mesh.visualisation.blocks.size(), order > 1 ? 2U : 1U);
      for (const mesh::Block& triangles : mesh.visualisation.blocks)
        EXPECT_NEAR(enclosed_by(mesh, triangles), exact / 8, 1e-13) << kind << order;
      const Flux bottom = flux_of(mesh, 0), above = flux_of(mesh, 1), sides = flux_of(mesh, 2);
      EXPECT_NEAR((bottom.normal - Point(0, 0, -0.25)).norm(), 0, 1e-13) << kind << order;
      EXPECT_NEAR((above.normal - Point(0, 0, (prism ? 1 : top * top) / 4)).norm(), 0, 1e-13)
          << kind << order;
      EXPECT_NEAR(sides.area, prism ? 1 : side, 1e-13) << kind << order;
      EXPECT_NEAR(bottom.third + above.third + sides.third, exact / 8, 1e-13) << kind << order;
    }
}

// A triangle of size h misses the sphere by a share of h², and lines between the nodes of an edge of order p
// are p times as short as the edge.
TEST(Read, visualisation_surface_of_a_ball_has_all_nodes_of_its_faces_and_is_as_round) {
  const mesh::GmshSession gmsh;
  const test::SharedFile file(".geo",
                              "SetFactory(\"OpenCASCADE\"); Sphere(1) = {0, 0, 0, 1};\n"
                              "Mesh.MeshSizeMin = 0.3; Mesh.MeshSizeMax = 0.3;\n"
                              "Physical Volume(\"body\") = {1}; Physical Surface(\"top\") = {1};\n");
  for (int order = 2; order <= 3; ++order) {
    scene::Body body = test::body_of(file.path(), order);
    body.contact = {"top"};
    GlobalMesh mesh = mesh::read_mesh(body);
    ASSERT_EQ(mesh.visualisation.blocks.size(), 2U);
    const mesh::Block fine = mesh.visualisation.blocks[0], coarse = mesh.visualisation.blocks[1];
    EXPECT_EQ(fine.size(), coarse.size() * static_cast<std::size_t>(order * order));
    const std::set<std::int64_t> nodes(fine.node.begin(), fine.node.end());
    EXPECT_EQ(nodes.size(), fine.size() / 2 + 2);  // Euler: a closed surface without holes
    const double exact = 4 * std::numbers::pi / 3;
    EXPECT_NEAR((exact - enclosed_by(mesh, coarse)) / (exact - enclosed_by(mesh, fine)), order * order,
                0.05 * order * order);  // terms of h⁴, and gmsh spaces the nodes unevenly
  }
}

/// The nodes of the facets, each sorted.
std::multiset<std::vector<std::int64_t>> facets_of(const GlobalMesh& mesh) {
  std::multiset<std::vector<std::int64_t>> found;
  for (const mesh::Block& block : mesh.contact.blocks)
    for (std::size_t e = 0; e < block.size(); ++e) {
      const auto nodes = block.node.begin() + static_cast<std::ptrdiff_t>(e) * block.nodes_per_element;
      std::vector<std::int64_t> sorted(nodes, nodes + block.nodes_per_element);
      std::ranges::sort(sorted);
      found.insert(std::move(sorted));
    }
  return found;
}

// A facet whose nodes are in another order, or which faces inward, changes the fluxes.
TEST(Read, contact_all_is_what_physical_surfaces_on_all_sides_are) {
  const mesh::GmshSession gmsh;
  for (const char* kind : {"tet", "hex", "prism"})
    for (int order = 1; order <= 3; ++order) {
      const bool prism = kind == std::string("prism");
      const test::SharedFile file(".geo", prism ? test::prism_geo(2) : test::block_geo(kind, 2, 0.4));
      scene::Body body = test::body_of(file.path(), order);
      body.contact = {"bottom", "top", "sides"};
      const GlobalMesh named = mesh::read_mesh(body);
      body.contact = {"all"};
      const GlobalMesh mesh = mesh::read_mesh(body);
      EXPECT_EQ(facets_of(mesh), facets_of(named)) << kind << order;
      const Flux all = flux_of(mesh, 0);
      EXPECT_NEAR(all.normal.norm(), 0, 1e-13) << kind << order;
      EXPECT_NEAR(all.third, volume_of(mesh), 1e-13) << kind << order;
      double area = 0;
      for (int g = 0; g < 3; ++g) area += flux_of(named, g).area;
      EXPECT_NEAR(all.area, area, 1e-13) << kind << order;
    }
}

TEST(Read, contact_all_is_a_physical_surface_if_one_has_this_name) {
  const mesh::GmshSession gmsh;
  const test::SharedFile file(".geo",
                              test::block_geo("hex", 2, 0.4) + "Physical Surface(\"all\") = {1, 2};\n");
  scene::Body body = test::body_of(file.path(), 2);
  body.contact = {"all"};
  EXPECT_NEAR(flux_of(mesh::read_mesh(body), 0).area, 1.36, 1e-13);
}

TEST(Read, elements_of_order_p_have_the_nodes_of_their_vertices_edges_faces_and_interiors) {
  const mesh::GmshSession gmsh;
  const test::SharedFile tets(".geo", test::block_geo("tet", 2, 0.3)),
      cubes(".geo", test::block_geo("hex", 3, 0));
  const GlobalMesh linear = mesh::read_mesh(test::body_of(tets.path(), 1));
  std::set<std::set<std::int64_t>> edges, faces;
  const mesh::Block& block = linear.blocks.at(0);
  for (std::size_t e = 0; e < block.size(); ++e)
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < a; ++b) {
        edges.insert({block.node[4 * e + a], block.node[4 * e + b]});
        for (int c = 0; c < b; ++c)
          faces.insert({block.node[4 * e + a], block.node[4 * e + b], block.node[4 * e + c]});
      }
  for (std::size_t p = 1; p <= 4; ++p) {
    const std::size_t expected = linear.fixed.size() + edges.size() * (p - 1) +
                                 faces.size() * (p - 1) * (p - 2) / 2 +
                                 block.size() * (p - 1) * (p - 2) * (p - 3) / 6;
    const GlobalMesh mesh = mesh::read_mesh(test::body_of(tets.path(), static_cast<int>(p)));
    EXPECT_EQ(mesh.fixed.size(), expected) << p;
    EXPECT_EQ(elements_of(mesh.blocks), block.size());
    const GlobalMesh cube = mesh::read_mesh(test::body_of(cubes.path(), static_cast<int>(p)));
    EXPECT_EQ(cube.fixed.size(), std::pow(3 * p + 1, 3)) << p;
    EXPECT_EQ(elements_of(cube.blocks), 27U);
  }
}

TEST(Read, order_of_the_scene_overrides_that_of_the_geometry) {
  const mesh::GmshSession gmsh;
  const test::SharedFile file(".geo", "Mesh.ElementOrder = 3;\n" + test::block_geo("hex", 1, 0));
  for (int order : {1, 2, 3}) EXPECT_EQ(mesh::read_mesh(test::body_of(file.path(), order)).order, order);
}

TEST(Read, geometry_sets_what_the_file_defines) {
  const test::SharedFile file(
      ".geo",
      "DefineConstant[ height = {1, Name \"Parameters/height\"}, layers = 2 ];\nSetFactory(\"Built-in\");\n"
      "Point(1) = {0,0,0};\nPoint(2) = {1,0,0};\nLine(1) = {1,2};\nTransfinite Curve{1} = 2;\n"
      "s[] = Extrude {0,1,0} { Line{1}; Layers{1}; Recombine; };\n"
      "v[] = Extrude {0,0,height} { Surface{s[1]}; Layers{layers}; Recombine; };\n");
  scene::Body body = test::body_of(file.path(), 1);
  const auto measure = [&] {
    const mesh::GmshSession gmsh;
    const GlobalMesh mesh = mesh::read_mesh(body);
    return std::pair(elements_of(mesh.blocks), volume_of(mesh));
  };
  EXPECT_EQ(measure().first, 2U);
  body.geometry = {{"height", 2.5}, {"layers", 5}};
  const auto [elements, volume] = measure();
  EXPECT_EQ(elements, 5U);
  EXPECT_NEAR(volume, 2.5, 1e-13);
}

// The parameters of gmsh persist after its session unless they are cleared.
TEST(Read, parameters_of_one_body_are_not_those_of_the_next) {
  const auto block = [](int layers) {
    return fmt::format("DefineConstant[ layers = {{{}, Name \"layers\"}} ];\nSetFactory(\"Built-in\");\n",
                       layers) +
           "Point(1) = {0,0,0};\nPoint(2) = {1,0,0};\nLine(1) = {1,2};\nTransfinite Curve{1} = 2;\n"
           "s[] = Extrude {0,1,0} { Line{1}; Layers{1}; Recombine; };\n"
           "v[] = Extrude {0,0,1} { Surface{s[1]}; Layers{layers}; Recombine; };\n";
  };
  const test::SharedFile first(".geo", block(3)), second(".geo", block(2));
  const auto elements = [](const std::filesystem::path& file, const std::map<std::string, double>& geometry) {
    const mesh::GmshSession gmsh;
    scene::Body body = test::body_of(file, 1);
    body.geometry = geometry;
    return elements_of(mesh::read_mesh(body).blocks);
  };
  EXPECT_EQ(elements(first.path(), {}), 3U);
  EXPECT_EQ(elements(second.path(), {}), 2U);
  EXPECT_EQ(elements(first.path(), {{"layers", 5}}), 5U);
  EXPECT_EQ(elements(second.path(), {}), 2U);
}

/// A file that gmsh writes on rank 0 from the model that `build` creates, and that all ranks read.
class Written {
 public:
  Written(const std::string& extension, const std::function<void()>& build) : file_(extension, "") {
    if (parallel::rank_of(PETSC_COMM_WORLD) == 0) {
      build();
      gmsh::write(file_.path().string());
    }
    MPI_Barrier(PETSC_COMM_WORLD);
  }
  const std::filesystem::path& path() const { return file_.path(); }

 private:
  test::SharedFile file_;
};

TEST(Read, a_mesh_written_by_gmsh_is_the_mesh_of_its_geometry) {
  const mesh::GmshSession gmsh;
  const test::SharedFile file(".geo", test::block_geo("tet", 2, 0.4));
  scene::Body body = test::body_of(file.path(), 3);
  body.contact = {"top"};
  const GlobalMesh made = mesh::read_mesh(body);
  for (double version : {2.2, 4.1})
    for (int binary : {0, 1}) {
      const Written written(".msh", [&] {
        mesh::read_mesh(body);
        gmsh::option::setNumber("Mesh.MshFileVersion", version);
        gmsh::option::setNumber("Mesh.Binary", binary);
      });
      scene::Body again = body;
      again.mesh = written.path();
      again.order = 1;  // a .msh file keeps its own order
      const GlobalMesh read = mesh::read_mesh(again);
      EXPECT_EQ(read.order, 3);
      EXPECT_EQ(read.fixed.size(), made.fixed.size());
      EXPECT_EQ(elements_of(read.blocks), elements_of(made.blocks));
      EXPECT_NEAR(volume_of(read), volume_of(made), 1e-13);
      EXPECT_NEAR((flux_of(read, 0).normal - Point(0, 0, 0.36)).norm(), 0, 1e-13);
    }
}

TEST(Read, files_of_cad_programs_need_no_groups) {
  const double pi = std::numbers::pi;
  for (const char* extension : {".brep", ".step"}) {
    const mesh::GmshSession gmsh;
    const Written part(extension, [] {
      gmsh::model::add("part");
      gmsh::model::occ::addCylinder(0, 0, 0, 0, 0, 2, 1);
      gmsh::model::occ::synchronize();
    });
    // A cylinder has three surfaces. The lateral one is the first.
    scene::Body body = test::body_of(part.path(), 3);
    body.contact = {"surface 1", "surface 2", "surface 3"};
    body.support = {{"surface 3", "z"}};
    const GlobalMesh mesh = mesh::read_mesh(body);
    // gmsh places about six cubic facets around the circle.
    EXPECT_NEAR(volume_of(mesh) / (2 * pi), 1, 0.003) << extension;
    double area = 0, whole = 0;
    for (int g = 0; g < 3; ++g) {
      const Flux flux = flux_of(mesh, g);
      area += flux.area;
      whole += flux.third;
      EXPECT_NEAR(flux.area / (g == 0 ? 4 * pi : pi), 1, 0.003) << extension << g;
    }
    EXPECT_NEAR(area / (6 * pi), 1, 0.003);
    EXPECT_NEAR(whole, volume_of(mesh), 1e-12);
    const double fixed = flux_of(mesh, 2).normal[2] > 0 ? 2 : 0;
    for (std::size_t n = 0; n < mesh.fixed.size(); ++n)
      EXPECT_EQ(mesh.fixed[n], std::abs(mesh.position[3 * n + 2] - fixed) < 1e-9 ? 4 : 0);
    body.contact = {"all"};
    const GlobalMesh everywhere = mesh::read_mesh(body);
    EXPECT_NEAR(flux_of(everywhere, 0).third, whole, 1e-12);
    EXPECT_NEAR(flux_of(everywhere, 0).area, area, 1e-12);
    body.contact = {"surface 4"};
    EXPECT_THROW(mesh::read_mesh(body), InputError);
  }
}

TEST(Read, supports_hold_their_components_on_their_nodes_only) {
  const mesh::GmshSession gmsh;
  const test::SharedFile file(".geo", test::block_geo("hex", 2, 0));
  scene::Body body = test::body_of(file.path(), 2);
  body.support = {{"bottom", "xz"}, {"surface 6", "y"}};  // surface 6: x = 0
  const GlobalMesh mesh = mesh::read_mesh(body);
  std::size_t fixed = 0;
  for (std::size_t n = 0; n < mesh.fixed.size(); ++n) {
    const Point x = at(mesh, static_cast<std::int64_t>(n));
    EXPECT_EQ(mesh.fixed[n], (x[2] < 1e-9 ? 5 : 0) | (x[0] < 1e-9 ? 2 : 0));
    fixed += mesh.fixed[n] != 0;
  }
  EXPECT_EQ(fixed, 25U + 20U);
}

TEST(Read, rods_have_their_axis_ends_and_supports) {
  const mesh::GmshSession gmsh;
  const test::SharedFile file(
      ".geo",
      "Point(1) = {1,1,0};\nPoint(2) = {4,5,0};\nLine(1) = {2,1};\nTransfinite Curve{1} = 6;\n"
      "Physical Curve(\"rod\") = {1};\nPhysical Point(\"low\") = {1};\nPhysical Point(\"high\") = {2};\n");
  scene::Body body = test::body_of(file.path(), 2);
  body.contact = {"low", "high"};
  body.support = {{"low", "yz"}};
  const GlobalMesh mesh = mesh::read_mesh(body);
  EXPECT_EQ(mesh.dim, 1);
  EXPECT_EQ(mesh.fixed.size(), 11U);
  const Point axis(mesh.axis.data()), exact(0.6, 0.8, 0);
  EXPECT_NEAR(std::abs(axis.dot(exact)), 1, 1e-14);
  const mesh::Block& ends = mesh.contact.blocks.at(0);
  ASSERT_EQ(ends.size(), 2U);
  for (std::size_t e = 0; e < 2; ++e) {
    const bool low = ends.label[e] == 0;
    const auto node = static_cast<std::size_t>(ends.node[e]);
    EXPECT_NEAR((at(mesh, ends.node[e]) - (low ? Point(1, 1, 0) : Point(4, 5, 0))).norm(), 0, 1e-14);
    // The rods of body_of have a cross-section of 0.5.
    EXPECT_NEAR((Point(&mesh.contact.end_normal[3 * node]) - (low ? -0.5 : 0.5) * exact).norm(), 0, 1e-14);
    EXPECT_EQ(mesh.fixed[node], low ? 1U : 0U);
  }
}

}  // namespace read_test
}  // namespace ricochet
