// SPDX-License-Identifier: BSD-2-Clause
// Contact patches compared with values derived by hand and with closed forms of hats on flat triangles.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "src/mesh/lattice.hpp"
#include "src/mesh/partition.hpp"
#include "src/mesh/read.hpp"
#include "src/surface/patches.hpp"
#include "tests/meshes.hpp"

namespace ricochet {
namespace patches_test {

using surface::Patches;
using surface::PatchOptions;
using Point = Eigen::Vector3d;

constexpr double placed = 1e-11;  // gmsh divides a line evenly to about 2e-12

struct Made {
  mesh::Mesh mesh;
  Patches patches;
};

Made make(const std::string& geo, int order, const std::vector<std::string>& contact,
          const PatchOptions& options = {}) {
  const test::SharedFile file(".geo", geo);
  scene::Body body = test::body_of(file.path(), order);
  body.contact = contact;
  Made made{test::mesh_of(body), {}};
  made.patches = surface::make_patches(made.mesh, contact, options);
  // The patches are the same as on one rank, bitwise except for the numbering of the nodes.
  const auto alone = mesh::distribute(mesh::read_mesh(body), PETSC_COMM_SELF);
  const Patches same = surface::make_patches(alone, contact, options);
  EXPECT_EQ(made.patches.geometry.node, same.geometry.node);
  EXPECT_EQ(made.patches.geometry.centroid, same.geometry.centroid);
  EXPECT_EQ(made.patches.geometry.bulge, same.geometry.bulge);
  EXPECT_EQ(made.patches.geometry.normal, same.geometry.normal);
  EXPECT_EQ(made.patches.geometry.element_normal, same.geometry.element_normal);
  EXPECT_EQ(made.patches.geometry.area, same.geometry.area);
  EXPECT_EQ(made.patches.geometry.group, same.geometry.group);
  EXPECT_EQ(made.patches.geometry.element, same.geometry.element);
  EXPECT_EQ(made.patches.weights.size(), same.weights.size());
  for (std::size_t w = 0; w < std::min(made.patches.weights.size(), same.weights.size()); ++w) {
    EXPECT_EQ(made.patches.weights[w].candidate, same.weights[w].candidate);
    EXPECT_EQ(made.patches.weights[w].value, same.weights[w].value);
  }
  return made;
}

Point row(const std::vector<double>& values, std::size_t i) { return Point(&values[3 * i]); }

double total(const std::vector<double>& values) {
  double sum = 0;
  for (double v : values) sum += v;
  return sum;
}

/// Σ weight · f(node) of each patch: the mean of the finite-element field with the nodal values f.
template <class Field>
std::vector<double> means(const Made& made, Field&& field) {
  std::map<std::int64_t, Point> place;
  const mesh::FacetMesh& contact = made.mesh.contact;
  for (std::size_t i = 0; i < contact.node.size(); ++i) place[contact.node[i]] = row(contact.position, i);
  std::vector<double> mean(made.patches.geometry.size(), 0);
  for (const surface::Weight& w : made.patches.weights)
    mean[static_cast<std::size_t>(w.candidate)] += w.value * field(place.at(w.node));
  return mean;
}

/// (1/A) ∫ w x ds and A of hats on flat triangles: A = Σ T/3, ∫ w_a x = Σ T (2a + b + c)/12.
void flat_hats(const mesh::FacetMesh& facets, std::vector<double>& area, std::vector<Point>& centroid) {
  area.assign(facets.node.size(), 0);
  centroid.assign(facets.node.size(), Point::Zero());
  for (const mesh::Block& block : facets.blocks) {
    const auto lattice = mesh::lattice_of(mesh::reference_element(block.gmsh_type));
    for (std::size_t e = 0; e < block.size(); ++e)
      for (const auto& cell : lattice.cells) {
        std::array<std::size_t, 3> node{};
        Point sum = Point::Zero();
        for (int k = 0; k < 3; ++k) {
          node[k] = static_cast<std::size_t>(block.node[e * block.nodes_per_element + cell[k]]);
          sum += row(facets.position, node[k]);
        }
        const Point a = row(facets.position, node[0]);
        const double t =
            (row(facets.position, node[1]) - a).cross(row(facets.position, node[2]) - a).norm() / 2;
        for (std::size_t n : node) {
          area[n] += t / 3;
          centroid[n] += t / 12 * (row(facets.position, n) + sum);
        }
      }
  }
  for (std::size_t n = 0; n < area.size(); ++n) centroid[n] /= area[n];
}

TEST(Patches, of_flat_triangles_have_the_mean_of_a_linear_field_at_their_centroid) {
  const mesh::GmshSession gmsh;
  for (int order = 1; order <= 4; ++order) {
    const Made made = make(test::block_geo("tet", 2, 0.4), order, {"top"});
    std::vector<double> area;
    std::vector<Point> centroid;
    flat_hats(made.mesh.contact, area, centroid);
    const auto& geometry = made.patches.geometry;
    ASSERT_EQ(geometry.size(), area.size());
    const auto ones = means(made, [](const Point&) { return 1.0; });
    const auto linear = means(made, [](const Point& x) { return 0.3 - 2 * x[0] + 5 * x[1] + x[2]; });
    for (std::size_t i = 0; i < area.size(); ++i) {
      EXPECT_NEAR(geometry.area[i], area[i], 1e-14);
      EXPECT_NEAR(ones[i], 1, 1e-13);
      // The patches at the ends are measured there, the others at their means.
      const Point at = row(geometry.centroid, i);
      const auto end = [](double x) { return std::min(std::abs(x - 0.2), std::abs(x - 0.8)) < placed; };
      const Point node = row(geometry.node, i);
      if (end(node[0]) || end(node[1])) {
        EXPECT_TRUE(end(at[0]) || end(at[1])) << at.transpose();
      } else {
        EXPECT_NEAR((at - centroid[i]).norm(), 0, 1e-12);
      }
      EXPECT_NEAR(geometry.bulge[i], 0, 1e-13);
      EXPECT_NEAR(linear[i], 0.3 - 2 * centroid[i][0] + 5 * centroid[i][1] + centroid[i][2], 1e-12);
      // Gradients of order 4 sum to zero within about 1e-13.
      EXPECT_NEAR((row(geometry.normal, i) - Point(0, 0, 1)).norm(), 0, 1e-12);
      EXPECT_EQ(geometry.group[i], "top");
    }
    EXPECT_NEAR(total(geometry.area), 0.36, 1e-14);
  }
}

TEST(Patches, of_a_grid_of_squares_have_the_areas_and_centroids_of_its_hats) {
  const mesh::GmshSession gmsh;
  for (int order = 1; order <= 3; ++order) {
    const Made made = make(test::block_geo("hex", 2, 0), order, {"top"});
    const double h = 0.5 / order;
    const auto& geometry = made.patches.geometry;
    ASSERT_EQ(geometry.size(), static_cast<std::size_t>((2 * order + 1) * (2 * order + 1)));
    EXPECT_EQ(geometry.element.size(), static_cast<std::size_t>(3 * 2 * 4 * order * order));
    // At an edge, half a hat remains, with its centroid h/3 inside.
    const auto centre = [&](double x) { return x < h / 2 ? h / 3 : x > 1 - h / 2 ? 1 - h / 3 : x; };
    const auto width = [&](double x) { return x < h / 2 || x > 1 - h / 2 ? h / 2 : h; };
    const auto x = means(made, [](const Point& p) { return p[0]; });
    const auto y = means(made, [](const Point& p) { return p[1]; });
    for (std::size_t i = 0; i < geometry.size(); ++i) {
      const Point node = row(geometry.node, i);
      EXPECT_NEAR(geometry.area[i], width(node[0]) * width(node[1]), placed);
      EXPECT_NEAR(x[i], centre(node[0]), placed);
      EXPECT_NEAR(y[i], centre(node[1]), placed);
    }
  }
}

TEST(Patches, of_a_cylinder_partition_its_area_and_point_outward) {
  const mesh::GmshSession gmsh;
  const std::string geo =
      "SetFactory(\"OpenCASCADE\");\nCylinder(1) = {0,0,0, 0,0,2, 1};\nMeshSize{:} = 0.5;\n"
      "Physical Volume(\"body\") = {1};\nPhysical Surface(\"mantle\") = {1};\n";
  const Made made = make(geo, 3, {"mantle"});
  const auto& geometry = made.patches.geometry;
  EXPECT_NEAR(total(geometry.area) / (4 * std::numbers::pi), 1, 1e-4);
  for (std::size_t i = 0; i < geometry.size(); ++i) {
    EXPECT_GT(geometry.area[i], 0);
    const Point x = row(geometry.node, i);
    // Mean normal of a patch that is about h/3 wide and not necessarily symmetric about its node.
    EXPECT_GT(row(geometry.normal, i).dot(Point(x[0], x[1], 0)), 0.99);
  }
}

TEST(Patches, belong_to_the_group_they_lie_on) {
  const mesh::GmshSession gmsh;
  const Made made = make(test::block_geo("hex", 2, 0), 1, {"top", "bottom"});
  const auto& geometry = made.patches.geometry;
  ASSERT_EQ(geometry.size(), 18U);
  for (std::size_t i = 0; i < 18; ++i) {
    EXPECT_EQ(geometry.group[i], geometry.node[3 * i + 2] > 0.5 ? "top" : "bottom");
    EXPECT_NEAR(geometry.normal[3 * i + 2], geometry.node[3 * i + 2] > 0.5 ? 1 : -1, 1e-13);
  }
  EXPECT_NEAR(total(geometry.area), 2, 1e-14);
}

TEST(Along, merges_all_vertices_on_a_line) {
  const mesh::GmshSession gmsh;
  for (int order : {1, 2}) {
    // Across y, the square consists of 2·order + 1 strips along y.
    const Made made = make(test::block_geo("hex", 2, 0), order, {"top"}, {.along = Vector3{0, 1, 0}});
    const auto& geometry = made.patches.geometry;
    const double h = 0.5 / order;
    ASSERT_EQ(geometry.size(), static_cast<std::size_t>(2 * order + 1));
    EXPECT_EQ(geometry.element_corners, 2);
    EXPECT_EQ(geometry.element.size(), 2U * 2 * order);
    for (std::size_t i = 0; i < geometry.size(); ++i) {
      const Point node = row(geometry.node, i);
      EXPECT_NEAR(node[1], 0.5, placed);
      EXPECT_NEAR(node[2], 1, placed);
      EXPECT_NEAR(geometry.area[i], node[0] < h / 2 || node[0] > 1 - h / 2 ? h / 2 : h, placed);
    }
    for (double y : means(made, [](const Point& p) { return p[1]; })) EXPECT_NEAR(y, 0.5, placed);
    for (double one : means(made, [](const Point&) { return 1.0; })) EXPECT_NEAR(one, 1, placed);
  }
}

TEST(Along, keeps_opposite_faces_apart) {
  const mesh::GmshSession gmsh;
  const Made made = make(test::block_geo("hex", 2, 0), 1, {"top", "bottom"}, {.along = Vector3{0, 0, 1}});
  ASSERT_EQ(made.patches.geometry.size(), 18U);
  for (std::size_t i = 0; i < 18; ++i)
    EXPECT_NEAR(std::abs(made.patches.geometry.normal[3 * i + 2]), 1, 1e-12);
}

TEST(Spacing, coarsens_a_row_to_evenly_spaced_hats_that_keep_its_area) {
  const mesh::GmshSession gmsh;
  // The strips are 1/8 apart and the requested spacing is 1/4. Hats of this radius lie at 0, ¼, ½, ¾ and 1,
  // so the merged hats are the wide ones.
  const Made made =
      make(test::block_geo("hex", 8, 0), 1, {"top"}, {.along = Vector3{0, 1, 0}, .spacing = 0.25});
  const auto& geometry = made.patches.geometry;
  ASSERT_EQ(geometry.size(), 5U);
  const auto x = means(made, [](const Point& p) { return p[0]; });
  for (std::size_t i = 0; i < 5; ++i) {
    const double at = geometry.node[3 * i];
    EXPECT_NEAR(std::remainder(at, 0.25), 0, placed);
    const bool edge = at < 0.1 || at > 0.9;
    EXPECT_NEAR(geometry.area[i], edge ? 0.125 : 0.25, placed);
    EXPECT_NEAR(x[i], at < 0.1 ? 0.25 / 3 : at > 0.9 ? 1 - 0.25 / 3 : at, placed);
  }
}

// The front starts at the lowest corner, and each next centre is the nearest one at least 1/4 away.
TEST(Spacing, coarsens_a_grid_to_a_grid) {
  const mesh::GmshSession gmsh;
  for (const int divisions : {4, 8, 12}) {
    SCOPED_TRACE(divisions);
    const Made made = make(test::block_geo("hex", divisions, 0), 1, {"top"}, {.spacing = 0.25});
    const auto& geometry = made.patches.geometry;
    ASSERT_EQ(geometry.size(), 25U);
    std::set<std::pair<long, long>> places;
    for (std::size_t i = 0; i < 25; ++i) {
      const Point x = row(geometry.node, i);
      EXPECT_NEAR(std::remainder(x[0], 0.25), 0, placed);
      EXPECT_NEAR(std::remainder(x[1], 0.25), 0, placed);
      places.emplace(std::lround(4 * x[0]), std::lround(4 * x[1]));
    }
    EXPECT_EQ(places.size(), 25U);
    EXPECT_NEAR(total(geometry.area), 1, 1e-13);
    // Elements are triangles between three centres, each of them once.
    ASSERT_EQ(geometry.element_corners, 3);
    std::set<std::set<std::int64_t>> seen;
    for (std::size_t k = 0; k < geometry.element.size(); k += 3)
      seen.emplace(geometry.element.begin() + static_cast<std::ptrdiff_t>(k),
                   geometry.element.begin() + static_cast<std::ptrdiff_t>(k) + 3);
    EXPECT_EQ(3 * seen.size(), geometry.element.size());
    for (const auto& corners : seen) {
      EXPECT_EQ(corners.size(), 3U);
      EXPECT_LT(*corners.rbegin(), 25);
    }
    // On the grid itself, they are the two triangles of each square.
    if (divisions == 4) {
      EXPECT_EQ(seen.size(), 32U);
    }
  }
}

TEST(Spacing, keeps_centres_apart_covers_the_surface_and_its_linear_fields) {
  const mesh::GmshSession gmsh;
  for (double spacing : {0.0, 0.2, 0.45, 3.0}) {
    PatchOptions options;
    if (spacing > 0) options.spacing = spacing;
    const Made made = make(test::block_geo("tet", 6, 0), 1, {"top", "bottom"}, options);
    const auto& geometry = made.patches.geometry;
    EXPECT_NEAR(total(geometry.area), 2, 1e-13);
    for (double one : means(made, [](const Point&) { return 1.0; })) EXPECT_NEAR(one, 1, 1e-13);
    // For any patches, ∫ x ds over both squares is that of the surface. Top and bottom never mix.
    double moment = 0;
    const auto x = means(made, [](const Point& p) { return p[0]; });
    const auto z = means(made, [](const Point& p) { return p[2]; });
    for (std::size_t i = 0; i < geometry.size(); ++i) {
      moment += geometry.area[i] * x[i];
      EXPECT_NEAR(z[i], geometry.group[i] == "top" ? 1 : 0, 1e-13);
      for (std::size_t j = 0; j < i; ++j) {
        if (geometry.group[i] != geometry.group[j]) continue;
        EXPECT_GT((row(geometry.node, i) - row(geometry.node, j)).norm(), spacing * (1 - 1e-5));
      }
    }
    EXPECT_NEAR(moment, 1, 1e-13);
    if (spacing == 3.0) {
      EXPECT_EQ(geometry.size(), 2U);
    }
  }
}

TEST(Crests, of_a_box_lie_on_its_faces_edges_and_corners_and_do_not_bulge) {
  const mesh::GmshSession gmsh;
  const std::vector<std::string> all{"bottom", "top", "sides"};
  for (const auto& [kind, divisions, order, spacing] :
       {std::tuple("tet", 3, 1, 0.0), std::tuple("tet", 2, 2, 0.0), std::tuple("hex", 2, 3, 0.0),
        std::tuple("tet", 5, 1, 0.4)}) {
    PatchOptions options;
    if (spacing > 0) options.spacing = spacing;
    const auto& geometry = make(test::block_geo(kind, divisions, 0), order, all, options).patches.geometry;
    std::array<int, 4> places{};
    for (std::size_t i = 0; i < geometry.size(); ++i) {
      const Point node = row(geometry.node, i), at = row(geometry.centroid, i);
      int faces = 0;
      for (int d = 0; d < 3; ++d) {
        if (std::min(node[d], 1 - node[d]) > placed) continue;
        ++faces;
        EXPECT_NEAR(at[d], node[d], placed);
      }
      ++places[static_cast<std::size_t>(faces)];
      EXPECT_NEAR(geometry.bulge[i], 0, 1e-12);
    }
    EXPECT_EQ(places[0], 0);
    if (spacing == 0) {
      EXPECT_EQ(places[3], 8);
    }
    ASSERT_EQ(geometry.element_normal.size(), 3 * geometry.element.size());
    for (std::size_t k = 0; k < geometry.element.size(); ++k)  // along an axis, on each face its own
      EXPECT_NEAR(row(geometry.element_normal, k).cwiseAbs().maxCoeff(), 1, 1e-12);
  }
}

// On an edge whose pieces have the lengths l and m, the mean of the hat is (m − l)/3 from its vertex.
TEST(Crests, of_an_edge_lie_at_the_centroid_of_the_hat_on_it) {
  const mesh::GmshSession gmsh;
  std::string geo = test::block_geo("hex", 4, 0);
  geo.replace(geo.find("Transfinite Curve{1:12} = 5;"), 28, "Transfinite Curve{1:12} = 5 Using Bump 0.4;");
  const auto& geometry = make(geo, 1, {"bottom", "top", "sides"}).patches.geometry;
  std::vector<double> along;  // x of the nodes on the edge y = z = 0
  std::vector<double> crest;
  for (std::size_t i = 0; i < geometry.size(); ++i)
    if (row(geometry.node, i).tail<2>().norm() < placed) {
      along.push_back(geometry.node[3 * i]);
      crest.push_back(geometry.centroid[3 * i]);
    }
  std::ranges::sort(along);
  std::ranges::sort(crest);
  ASSERT_EQ(along.size(), 5U);
  EXPECT_GT(std::abs(along[2] - along[1] - (along[1] - along[0])), 0.05);
  for (std::size_t i = 1; i < 4; ++i)
    EXPECT_NEAR(crest[i], along[i] + (along[i + 1] - 2 * along[i] + along[i - 1]) / 3, placed);
}

std::string ball_geo(double size) {
  return fmt::format(
      "SetFactory(\"OpenCASCADE\");\nSphere(1) = {{0,0,0, 1}};\nMeshSize{{:}} = {};\n"
      "Physical Volume(\"body\") = {{1}};\nPhysical Surface(\"skin\") = {{1}};\n",
      size);
}

// On a sphere of radius 1, n·(x̂ − x) = |x − x̂|²/2 for every point x of it.
TEST(Crests, of_a_ball_lie_on_it_and_bulge_by_the_mean_height_over_the_patch) {
  const mesh::GmshSession gmsh;
  for (const auto& [order, size] : {std::pair(2, 0.4), std::pair(3, 0.5)}) {
    // Meshed once, because gmsh places the nodes inside a sphere differently by round-off every time.
    const test::SharedFile file(".geo", ball_geo(size));
    scene::Body body = test::body_of(file.path(), order);
    body.contact = {"skin"};
    Made made{test::mesh_of(body), {}};
    made.patches = surface::make_patches(made.mesh, body.contact, {});
    const auto& geometry = made.patches.geometry;
    std::array<std::vector<double>, 3> mean;
    for (int d = 0; d < 3; ++d) mean[d] = means(made, [d](const Point& x) { return x[d]; });
    constexpr double off = 1e-3;  // of elements from the sphere
    int on_sphere = 0;
    double bulges = 0, heights = 0;
    const auto square = means(made, [](const Point& x) { return x.squaredNorm(); });
    for (std::size_t i = 0; i < geometry.size(); ++i) {
      const Point at = row(geometry.centroid, i), of_patch(mean[0][i], mean[1][i], mean[2][i]);
      const double bulge = geometry.bulge[i],
                   height = (square[i] - 2 * at.dot(of_patch) + at.squaredNorm()) / 2;
      // The gap to a tangential plane plus the bulge is the gap of the mean. 1.5 %: the normal of an element.
      EXPECT_NEAR(at.norm() - bulge, of_patch.dot(at) / at.norm(), 0.015 * bulge);
      EXPECT_GT(bulge, 5e-4);
      if (std::abs(at.norm() - 1) > off) continue;
      ++on_sphere;
      bulges += bulge;
      heights += height;
    }
    // The others lie on elements of this coarse mesh that have been straightened.
    EXPECT_GT(on_sphere, 0.8 * static_cast<double>(geometry.size()));
    // Single elements of order 2 have curvatures of their own.
    EXPECT_NEAR(bulges, heights, 0.03 * heights);
    ASSERT_EQ(geometry.element_normal.size(), 3 * geometry.element.size());
    for (std::size_t k = 0; k < geometry.element.size(); ++k) {
      const Point x = row(geometry.node, static_cast<std::size_t>(geometry.element[k]));
      EXPECT_GT(row(geometry.element_normal, k).dot(x), 0.98);
    }
  }
}

TEST(Crests, of_a_cylinder_with_its_ends_lie_on_the_rims) {
  const mesh::GmshSession gmsh;
  const std::string geo =
      "SetFactory(\"OpenCASCADE\");\nCylinder(1) = {0,0,0, 0,0,2, 1};\nMeshSize{:} = 0.5;\n"
      "Physical Volume(\"body\") = {1};\nPhysical Surface(\"skin\") = {1:3};\n";
  const auto& geometry = make(geo, 2, {"skin"}).patches.geometry;
  int rims = 0;
  for (std::size_t i = 0; i < geometry.size(); ++i) {
    const Point node = row(geometry.node, i), at = row(geometry.centroid, i);
    const bool end = std::min(node[2], 2 - node[2])<1e-9, mantle = node.head<2>().norm()> 1 - 1e-6;
    if (end) {
      EXPECT_NEAR(at[2], node[2], 1e-9);
    }
    if (mantle) {
      EXPECT_NEAR(at.head<2>().norm(), 1, 1e-3);
    }
    rims += end && mantle;
    // Patches of the mantle bulge by h²/12 with h from 0.2 to 0.3, those of the ends do not.
    if (end && !mantle) {
      EXPECT_NEAR(geometry.bulge[i], 0, 1e-12);
    } else {
      EXPECT_THAT(geometry.bulge[i], testing::AllOf(testing::Gt(5e-4), testing::Lt(1.2e-2)));
    }
  }
  EXPECT_GT(rims, 40);
}

TEST(Crests, of_strips_across_a_cylinder_lie_on_it_and_have_one_normal) {
  const mesh::GmshSession gmsh;
  const std::string geo =
      "SetFactory(\"OpenCASCADE\");\nDisk(1) = {0,0,0, 1};\nMeshSize{:} = 0.3;\n"
      "out[] = Extrude {0, 0, 0.3} { Surface{1}; Layers{2}; };\nPhysical Volume(\"body\") = {out[1]};\n"
      "Physical Surface(\"mantle\") = {out[2]};\n";
  const auto& geometry = make(geo, 2, {"mantle"}, {.along = Vector3{0, 0, 1}}).patches.geometry;
  ASSERT_EQ(geometry.element_corners, 2);
  ASSERT_EQ(geometry.element_normal.size(), 3 * geometry.element.size());
  std::map<std::int64_t, Point> normal;
  for (std::size_t i = 0; i < geometry.size(); ++i) {
    const Point at = row(geometry.centroid, i);
    EXPECT_NEAR(at.head<2>().norm(), 1, 1e-4);
    EXPECT_NEAR(at[2], 0.15, 1e-3);
    EXPECT_GT(geometry.bulge[i], 1e-3);
    EXPECT_LT(geometry.bulge[i], 1e-2);
  }
  for (std::size_t k = 0; k < geometry.element.size(); ++k) {
    const auto [known, first] = normal.try_emplace(geometry.element[k], row(geometry.element_normal, k));
    EXPECT_EQ(known->second, row(geometry.element_normal, k));
  }
}

TEST(Restriction, keeps_patches_and_loads_of_the_remaining_candidates) {
  const mesh::GmshSession gmsh;
  for (const PatchOptions& options :
       {PatchOptions{}, PatchOptions{.along = Vector3{0, 1, 0}, .spacing = 0.3}}) {
    Made made = make(test::block_geo("tet", 4, 0), 2, {"top"}, options);
    const kernels::Surface before = made.patches.geometry;
    const Eigen::MatrixXd loads = surface::patch_loads(made.mesh, made.patches);
    std::vector<std::int64_t> points;
    for (std::size_t i = 0; i < before.size(); ++i)
      if (before.node[3 * i] > 0.45) points.push_back(static_cast<std::int64_t>(i));
    ASSERT_GT(points.size(), 1U);
    ASSERT_LT(points.size(), before.size());
    surface::restrict_to(made.patches, points);
    const kernels::Surface& geometry = made.patches.geometry;
    const Eigen::MatrixXd kept = surface::patch_loads(made.mesh, made.patches);
    ASSERT_EQ(geometry.size(), points.size());
    ASSERT_EQ(kept.cols(), 3 * static_cast<Eigen::Index>(points.size()));
    for (std::size_t k = 0; k < points.size(); ++k) {
      const auto i = static_cast<std::size_t>(points[k]);
      EXPECT_EQ(geometry.area[k], before.area[i]);
      EXPECT_EQ(row(geometry.centroid, k), row(before.centroid, i));
      EXPECT_EQ(geometry.bulge[k], before.bulge[i]);
      EXPECT_EQ(row(geometry.normal, k), row(before.normal, i));
      EXPECT_EQ(geometry.group[k], before.group[i]);
      EXPECT_EQ(kept.middleCols(3 * static_cast<Eigen::Index>(k), 3), loads.middleCols(3 * points[k], 3));
    }
    ASSERT_TRUE(geometry.whole);
    EXPECT_EQ(geometry.whole->node, before.node);
    EXPECT_EQ(geometry.whole->element, before.element);
    EXPECT_EQ(geometry.whole->held, points);
    // Only the elements between remaining candidates are kept, with new numbers.
    ASSERT_FALSE(geometry.element.empty());
    EXPECT_LT(geometry.element.size(), before.element.size());
    for (const std::int64_t corner : geometry.element)
      EXPECT_LT(corner, static_cast<std::int64_t>(points.size()));
  }
}

TEST(Patches, of_a_body_without_contact_groups_are_refused) {
  const mesh::GmshSession gmsh;
  const test::SharedFile file(".geo", test::block_geo("hex", 1, 0));
  const mesh::Mesh mesh = test::mesh_of(test::body_of(file.path(), 1));
  EXPECT_THROW(surface::make_patches(mesh, {}, {}), InputError);
}

}  // namespace patches_test
}  // namespace ricochet
