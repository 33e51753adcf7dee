// SPDX-License-Identifier: BSD-2-Clause
// Points in and near bodies, compared with projections in closed form.
#include "src/surface/locate.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/meshes.hpp"

namespace ricochet {
namespace locate_test {

using surface::Located;
using Point = Eigen::Vector3d;

/// A mesh whose nodes are moved by a map, and their places before.
struct Moved {
  template <class Map>
  Moved(const std::string& geo, int order, Map&& map) {
    const test::SharedFile file(".geo", geo);
    mesh = test::mesh_of(test::body_of(file.path(), order));
    before.assign(static_cast<std::size_t>(3 * mesh.total_nodes), 0);
    for (std::size_t i = 0; i < mesh.node.size(); ++i) {
      Eigen::Map<Point> x(&mesh.position[3 * i]);
      if (mesh.owned(mesh.node[i]) >= 0)
        for (int k = 0; k < 3; ++k) before[3 * static_cast<std::size_t>(mesh.node[i]) + k] = x[k];
      x = map(Point(x));
    }
    parallel::sum(mesh.comm, before);
  }
  Located at(const Point& x) const { return surface::locate(mesh, {x[0], x[1], x[2]}); }
  /// The place before the map of what was found: the field of the places before, which elements represent
  /// exactly.
  Point origin(const Located& found) const {
    Point sum = Point::Zero();
    for (std::size_t a = 0; a < found.node.size(); ++a)
      sum += found.weight[a] * Point(&before[3 * static_cast<std::size_t>(found.node[a])]);
    return sum;
  }
  const mesh::GmshSession gmsh;
  mesh::Mesh mesh;
  std::vector<double> before;
};

Point same(const Point& x) { return x; }

std::string geo_of(const std::string& kind) {
  return kind == "prism" ? test::prism_geo(2) : test::block_geo(kind, 2, 0);
}

constexpr double placed = 1e-11;  // gmsh divides a line evenly to about 2e-12

// Points inside, on the surface and outside, of which none lies on a face between elements.
std::vector<Point> grid() {
  std::vector<Point> points;
  for (const double x : {-0.31, 0.17, 1.0})
    for (const double y : {0.0, 0.71, 1.32})
      for (const double z : {0.58, 1.29}) points.emplace_back(x, y, z);
  return points;
}

TEST(Locate, finds_the_nearest_point_of_a_cube_for_every_kind_of_element) {
  for (const char* kind : {"tet", "hex", "prism"})
    for (const int order : {1, 2}) {
      const Moved cube(geo_of(kind), order, same);
      for (const Point& x : grid()) {
        SCOPED_TRACE(testing::Message() << kind << " of order " << order << " at " << x.transpose());
        const Point nearest = x.cwiseMax(0).cwiseMin(1);
        const Located found = cube.at(x);
        // The distance is stationary, so the foot is less accurate than the distance.
        const double foot = x == nearest ? placed : 1e-8;
        EXPECT_NEAR(found.distance, (x - nearest).norm(), placed);
        EXPECT_LT((Point(found.place.data()) - nearest).norm(), foot);
        double sum = 0;
        for (const double weight : found.weight) sum += weight;
        EXPECT_NEAR(sum, 1, 1e-13);
        EXPECT_LT((cube.origin(found) - nearest).norm(), foot);
      }
    }
}

/// A dome on the cube, highest at x = 0.625, between the nodes of an element of order 2.
constexpr double height = 0.4;
double dome(double x) { return x - 0.8 * x * x; }
Point raise(const Point& x) { return {x[0], x[1], x[2] * (1 + height * dome(x[0]))}; }

TEST(Locate, finds_points_in_the_bulge_of_a_curved_element) {
  for (const int divisions : {1, 2}) {
    const Moved body(test::block_geo("hex", divisions, 0), 2, raise);
    for (const double x : {0.1, 0.55, 0.625, 0.7, 0.93})
      for (const double z : {0.02, 0.5, 0.97, 0.999}) {
        const Point from(x, 0.37, z);
        const Located found = body.at(raise(from));
        EXPECT_LT(found.distance, 1e-13) << from.transpose();
        EXPECT_LT((body.origin(found) - from).norm(), placed) << from.transpose();
      }
  }
}

// Along the normal of a convex surface, the foot is the nearest point.
TEST(Locate, finds_the_foot_on_a_convex_curved_surface) {
  for (const int divisions : {1, 2}) {
    const Moved body(test::block_geo("hex", divisions, 0), 2, raise);
    for (const double x : {0.1, 0.625})
      for (const double distance : {1e-3, 1.5}) {
        const Point from(x, 0.44, 1), foot = raise(from),
                                      normal = Point(-height * (1 - 1.6 * x), 0, 1).normalized();
        const Located found = body.at(foot + distance * normal);
        EXPECT_NEAR(found.distance, distance, placed) << x << ", " << distance;
        EXPECT_LT((Point(found.place.data()) - foot).norm(), 1e-7) << x << ", " << distance;
      }
  }
}

TEST(Locate, finds_the_foot_on_a_rod) {
  const Point axis = Point(1, 2, 2) / 3, start(1, 1, 1), across = Point(2, -2, 1) / 3;
  for (const int order : {1, 2, 3}) {
    const Moved rod(
        "Point(1) = {1,1,1};\nPoint(2) = {2,3,3};\nLine(1) = {1,2};\nTransfinite Curve{1} = 4;\n"
        "Physical Curve(\"rod\") = {1};\n",
        order, same);
    EXPECT_NEAR(surface::size_of(rod.mesh), 3, placed);
    for (const double s : {-0.4, 0.0, 0.3, 1.0, 1.7, 3.0, 3.6})
      for (const double off : {0.0, 0.5}) {
        const Point nearest = start + std::clamp(s, 0.0, 3.0) * axis, x = start + s * axis + off * across;
        const Located found = rod.at(x);
        EXPECT_NEAR(found.distance, (x - nearest).norm(), placed) << s << ", " << off;
        EXPECT_LT((rod.origin(found) - nearest).norm(), placed) << s << ", " << off;
      }
  }
}

TEST(Locate, of_a_body_without_elements_finds_the_nearest_node) {
  mesh::GlobalMesh global;
  for (int i = 0; i < 7; ++i) global.position.insert(global.position.end(), {0.5 * i, 0.1 * i * i, -1.0});
  global.fixed.assign(7, 0);
  const mesh::Mesh mesh = mesh::distribute(std::move(global), PETSC_COMM_WORLD);
  for (int i = 0; i < 7; ++i) {
    const Located found = surface::locate(mesh, {0.5 * i + 0.03, 0.1 * i * i - 0.04, -1.0});
    EXPECT_EQ(found.node, std::vector<std::int64_t>{i});
    EXPECT_EQ(found.weight, std::vector<double>{1});
    EXPECT_NEAR(found.distance, 0.05, 1e-15);
    EXPECT_EQ(found.place, (Vector3{0.5 * i, 0.1 * i * i, -1.0}));
  }
  EXPECT_NEAR(surface::size_of(mesh), std::hypot(3, 3.6), 1e-14);
}

TEST(SizeOf, a_body_is_the_diagonal_of_its_bounding_box) {
  const Moved body(test::block_geo("tet", 2, 0.4), 2,
                   [](const Point& x) -> Point { return Point(2, -3, 6).cwiseProduct(x) + Point(-5, 7, 1); });
  EXPECT_NEAR(surface::size_of(body.mesh), 7, placed);
}

}  // namespace locate_test
}  // namespace ricochet
