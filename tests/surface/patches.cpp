// SPDX-License-Identifier: BSD-2-Clause
// Contact patches compared with values derived by hand and with closed forms of hats on flat triangles.
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
  EXPECT_EQ(made.patches.geometry.normal, same.geometry.normal);
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
      EXPECT_NEAR((row(geometry.centroid, i) - centroid[i]).norm(), 0, 1e-13);
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
