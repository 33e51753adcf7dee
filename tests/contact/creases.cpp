// SPDX-License-Identifier: BSD-2-Clause
// Gaps between boxes, balls and cylinders whose true distances are known: on creases, at corners, where edges
// cross, and on curved elements.
#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <random>

#include "tests/contact/bodies.hpp"

namespace creases_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;

const Vector3d up(0, 0, 1);
constexpr double degree = std::numbers::pi / 180;
const PairRequest freely{"a", "b", {}, {}, {}};

/// Candidates at the vertices of a mesh of triangles with the normals of their faces.
class Triangles {
 public:
  /// @param normal  at each corner
  void triangle(const std::array<Vector3d, 3>& x, const std::array<Vector3d, 3>& normal) {
    for (int k = 0; k < 3; ++k) {
      const std::array<long, 3> key{std::lround(1e9 * x[k].x()), std::lround(1e9 * x[k].y()),
                                    std::lround(1e9 * x[k].z())};
      const auto [at, made] = number_.try_emplace(key, number_.size());
      if (made) {
        node_.push_back(x[k]);
        sum_.emplace_back(Vector3d::Zero());
      }
      sum_[at->second] += normal[k];
      kernel_.surface.element.push_back(static_cast<std::int64_t>(at->second));
      kernel_.surface.element_normal.insert(kernel_.surface.element_normal.end(), normal[k].begin(),
                                            normal[k].end());
    }
  }

  Kernel kernel() {
    kernel_.mass = 1;
    for (std::size_t i = 0; i < node_.size(); ++i) add_candidate(kernel_, node_[i], sum_[i], 1);
    return kernel_;
  }

 private:
  Kernel kernel_;
  std::map<std::array<long, 3>, std::size_t> number_;
  std::vector<Vector3d> node_, sum_;
};

/// A box from the origin, with this many intervals along each edge, whose inner nodes are moved at random in
/// their faces and edges.
Kernel box(const Vector3d& size, const std::array<int, 3>& count, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-0.3, 0.3);
  std::array<std::vector<double>, 3> at;
  for (int d = 0; d < 3; ++d)
    for (int i = 0; i <= count[d]; ++i)
      at[d].push_back(size[d] * (i == 0 || i == count[d] ? i : i + shift(random)) / count[d]);
  Triangles triangles;
  for (int d = 0; d < 3; ++d)
    for (int side = 0; side < 2; ++side) {
      const int e = (d + 1) % 3, f = (d + 2) % 3;
      const Vector3d normal = (side ? 1 : -1) * Vector3d::Unit(d);
      const auto x = [&](int i, int j) {
        Vector3d out;
        out[d] = side * size[d];
        out[e] = at[e][i];
        out[f] = at[f][j];
        return out;
      };
      for (int i = 0; i < count[e]; ++i)
        for (int j = 0; j < count[f]; ++j) {
          triangles.triangle({x(i, j), x(i + 1, j), x(i + 1, j + 1)}, {normal, normal, normal});
          triangles.triangle({x(i, j), x(i + 1, j + 1), x(i, j + 1)}, {normal, normal, normal});
        }
    }
  return triangles.kernel();
}

/// A cap of a sphere of radius r with the normals of the sphere.
Kernel smooth_cap(int n, double r, double width) {
  Kernel kernel = cap(n, r, width);
  for (const std::int64_t i : kernel.surface.element)
    for (int d = 0; d < 3; ++d) kernel.surface.element_normal.push_back(kernel.surface.normal[3 * i + d]);
  return kernel;
}

/// An axis-aligned square of side 2 at z = 0 that faces up, around the origin.
Kernel table(int n) {
  Triangles triangles;
  const auto x = [&](int i, int j) { return Vector3d(2.0 * i / n - 1, 2.0 * j / n - 1, 0); };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      triangles.triangle({x(i, j), x(i + 1, j), x(i + 1, j + 1)}, {up, up, up});
      triangles.triangle({x(i, j), x(i + 1, j + 1), x(i, j + 1)}, {up, up, up});
    }
  return triangles.kernel();
}

double smallest_gap(const Pairing& pairing) {
  double least = 1e300;
  for (const auto& point : pairing.points) least = std::min(least, point.gap);
  return least;
}

double lowest(const Kernel& kernel, const Matrix3d& Q) {
  double least = 1e300;
  for (std::size_t i = 0; i < kernel.surface.size(); ++i)
    least = std::min(least, (Q * Eigen::Map<const Vector3d>(&kernel.surface.node[3 * i])).z());
  return least;
}

TEST(Creases, of_a_tilted_box_are_at_their_true_distance_from_a_floor_and_from_a_table) {
  const double height = 1e-5;
  for (const Vector3d& tilt :
       {Vector3d(0, 10, 0), Vector3d(10, 10, 0), Vector3d(0, 0, 0), Vector3d(44, 3, 0)})
    for (const int n : {2, 5}) {
      const Kernel brick = box({0.6, 0.4, 0.2}, {n, n, n});
      const Matrix3d Q = turn(tilt.y() * degree, {0, 1, 0}) * turn(tilt.x() * degree, {1, 0, 0});
      const Vector3d at(-0.2, -0.2, height - lowest(brick, Q));
      const PlacedBody a{"a", &brick, Q, at};
      // 1e-14: coordinates of about 1
      EXPECT_NEAR(smallest_gap(pair(a, Obstacle{"b", Vector3d::Zero(), up}, freely)), height, 1e-14);
      for (const int m : {1, 3}) {
        const Kernel plate = table(m);
        EXPECT_NEAR(smallest_gap(pair(a, {"b", &plate}, freely)), height, 1e-14) << tilt.transpose();
        EXPECT_NEAR(smallest_gap(pair({"a", &plate}, {"b", &brick, Q, at}, freely)), height, 1e-14)
            << tilt.transpose();
        PairRequest down = freely;
        down.direction = up;
        EXPECT_NEAR(smallest_gap(pair({"a", &plate}, {"b", &brick, Q, at}, down)), height, 1e-14);
      }
    }
}

TEST(Creases, that_touch_a_face_push_along_its_normal) {
  const Kernel brick = box({0.6, 0.4, 0.2}, {3, 3, 3}), plate = table(4);
  const Matrix3d Q = turn(10 * degree, {0, 1, 0});
  const Vector3d at(-0.2, -0.2, 1e-5 - lowest(brick, Q));
  const auto pushes_up = [](const Pairing& pairing, double sense) {
    for (const auto& point : pairing.points)
      if (point.gap < 1.1e-5) {
        EXPECT_LT((point.normal - sense * up).norm(), 1e-12);
        EXPECT_EQ(point.bulge, 0);
      }
  };
  pushes_up(pair({"a", &brick, Q, at}, {"b", &plate}, freely), -1);
  pushes_up(pair({"a", &plate}, {"b", &brick, Q, at}, freely), 1);
}

/// Two bars of 0.1 × 0.1 that lie edge on edge at an angle: their edges are `apart` at one point, where
/// neither has a node.
std::pair<PlacedBody, PlacedBody> crossed(const Kernel& one, const Kernel& other, double angle, double apart,
                                          double along) {
  const Matrix3d edge_up = turn(45 * degree, {1, 0, 0});  // the edge at y = z = 0.1 is on top
  const Matrix3d edge_down = turn(angle, up) * turn(225 * degree, {1, 0, 0});
  PlacedBody a{"a", &one, edge_up}, b{"b", &other, edge_down};
  const Vector3d top = edge_up * Vector3d(0.4 + along, 0.1, 0.1),
                 bottom = edge_down * Vector3d(0.37, 0.1, 0.1);
  b.translation = top + apart * up - bottom;
  return {a, b};
}

TEST(Edges, that_cross_are_at_their_true_distance_on_any_mesh) {
  const double apart = 5.8e-5;
  for (const int n : {4, 9})
    for (const double angle : {90.0, 60.0, 15.0})
      for (const double along : {0.0, 0.03, 0.11}) {
        const Kernel one = box({1, 0.1, 0.1}, {n, 2, 2}, 3), other = box({1, 0.1, 0.1}, {n + 1, 1, 1}, 4);
        const auto [a, b] = crossed(one, other, angle * degree, apart, along);
        for (const auto& direction : {std::optional<Vector3d>(), std::optional<Vector3d>(up)}) {
          PairRequest request = freely;
          request.direction = direction;
          const Pairing pairing = pair(a, b, request);
          EXPECT_NEAR(smallest_gap(pairing), apart, 1e-14);
          int nearest = 0;
          for (const auto& point : pairing.points) {
            if (point.gap > apart + 1e-6) continue;
            ++nearest;
            EXPECT_LT((point.normal - up).norm(), 1e-12);
            double of_a = 0, of_b = 0;
            for (const auto& [i, weight] : point.of_a) of_a += weight;
            for (const auto& [j, weight] : point.of_b) of_b += weight;
            EXPECT_NEAR(of_a, 1, 1e-14);
            EXPECT_NEAR(of_b, 1, 1e-14);
          }
          EXPECT_EQ(nearest, 1);
        }
        PairRequest moved = freely;
        moved.gap = 1e-3;
        moved.direction = up;
        EXPECT_NEAR(pair(a, b, moved).shift.z(), apart - 1e-3, 1e-13);
      }
}

TEST(Edges, that_overlap_are_refused) {
  const Kernel bar = box({1, 0.1, 0.1}, {4, 1, 1}), other = box({1, 0.1, 0.1}, {5, 1, 1});
  const auto [a, b] = crossed(bar, other, 90 * degree, -1e-4, 0.03);
  EXPECT_NE(complaint_of([&, &a = a, &b = b] { pair(a, b, freely); }).find("overlap by 0.0001 m"),
            std::string::npos);
}

// A candidate of a is at every place where an edge of b could add a point.
TEST(Edges, of_boxes_with_matching_meshes_that_lie_on_each_other_add_no_points) {
  const Kernel brick = box({1, 1, 1}, {3, 3, 3});
  const Pairing pairing = pair({"a", &brick}, {"b", &brick, Matrix3d::Identity(), up}, freely);
  EXPECT_NEAR(smallest_gap(pairing), 0, 1e-15);
  for (const auto& point : pairing.points) EXPECT_EQ(point.of_a.size(), 1U);
}

// The sagitta of the chords is h²/8R; with curved elements, the distance between the balls is right to 1 % of
// it.
TEST(CurvedElements, follow_a_ball_between_its_nodes) {
  const double radius = 1, width = 0.3;
  const int n = 4;
  const double h = 2 * width / n;
  const Kernel fine = smooth_cap(14, radius, width), coarse = smooth_cap(n, radius, width);
  const double height = 2.01;
  const Pairing pairing = pair({"a", &fine}, {"b", &coarse, upside_down(), height * up}, freely);
  EXPECT_GT(pairing.points.size(), 150U);
  const double sagitta = h * h / 8 / radius;
  for (const auto& point : pairing.points) {
    EXPECT_NEAR((point.b - height * up).norm(), radius, 0.02 * sagitta);
    // The normal is interpolated between the corners.
    EXPECT_LT((point.normal - up).norm(), 5e-3);
  }
}

// Quadratic elements with spacing h deviate from a ball by a share of h²/6R.
TEST(CurvedElements, that_overlap_by_a_small_share_of_their_bulge_touch) {
  Kernel ball = smooth_cap(6, 1, 0.3);
  ball.surface.centroid = ball.surface.node;
  ball.surface.bulge.assign(ball.surface.size(), 0.001);
  const auto at = [&](double height) {
    return pair({"a", &ball, upside_down(), height * up}, Obstacle{"b", Vector3d::Zero(), up}, freely);
  };
  EXPECT_EQ(smallest_gap(at(1 - 4e-5)), 0);
  EXPECT_NE(complaint_of([&] { at(1 - 6e-5); }).find("overlap by 6e-05 m"), std::string::npos);
}

TEST(CurvedElements, follow_a_cylinder_up_to_its_rim) {
  Triangles triangles;
  const int n = 16;
  const auto at = [&](int i) { return 2 * std::numbers::pi * i / n; };
  const auto way = [&](int i) { return Vector3d(std::cos(at(i)), std::sin(at(i)), 0); };
  for (int i = 0; i < n; ++i) {
    const Vector3d p = way(i), q = way(i + 1);
    triangles.triangle({p, q, q + up}, {p, q, q});
    triangles.triangle({p, q + up, p + up}, {p, q, p});
    triangles.triangle({p + up, q + up, up}, {up, up, up});
  }
  const Kernel cylinder = triangles.kernel();
  // Straight above a point between two nodes, just inside the rim: on the chords there is nothing.
  Kernel probe;
  probe.mass = 1;
  probe.surface.element_corners = 1;
  probe.surface.element = {0};
  add_candidate(probe, 0.9999 * Vector3d(std::cos(at(1) / 2), std::sin(at(1) / 2), 0) + 1.5 * up, -up, 1);
  PairRequest down = freely;
  down.direction = -up;
  EXPECT_NEAR(pair({"a", &probe}, {"b", &cylinder}, down).points.at(0).gap, 0.5, 1e-9);
  // Towards the axis, half way up
  add_candidate(probe, 2 * Vector3d(std::cos(at(1) / 2), std::sin(at(1) / 2), 0) + 0.5 * up,
                -Vector3d(std::cos(at(1) / 2), std::sin(at(1) / 2), 0), 1);
  down.direction = -Vector3d(std::cos(at(1) / 2), std::sin(at(1) / 2), 0);
  EXPECT_NEAR(pair({"a", &probe}, {"b", &cylinder}, down).points.back().gap, 1, 1e-9);
}

TEST(TrueDistance, of_boxes_edges_and_balls_is_that_of_the_drawing) {
  // 1e-3 of the smallest element is its tolerance.
  const Kernel bar = box({1, 0.1, 0.1}, {4, 2, 2}), other = box({1, 0.1, 0.1}, {5, 1, 1}), plate = table(3);
  const auto [a, b] = crossed(bar, other, 50 * degree, 0.02, 0.03);
  EXPECT_NEAR(true_distance(a, b, freely)->distance, 0.02, 5e-5);
  const auto [c, d] = crossed(bar, other, 50 * degree, -0.01, 0.03);
  EXPECT_EQ(true_distance(c, d, freely)->distance, 0);
  const Matrix3d Q = turn(7 * degree, {1, 0, 0}) * turn(10 * degree, {0, 1, 0});
  const PlacedBody tilted{"a", &bar, Q, Vector3d(-0.5, 0, 0.003 - lowest(bar, Q))};
  EXPECT_NEAR(true_distance(tilted, {"b", &plate}, freely)->distance, 0.003, 5e-5);
  EXPECT_NEAR(true_distance(tilted, Obstacle{"b", Vector3d::Zero(), up})->distance, 0.003, 1e-14);
  EXPECT_EQ(true_distance(tilted, Obstacle{"b", up, up})->distance, 0);
  // Their poles lie between nodes: on chords, they would be h²/8R = 3e-3 apart for each ball.
  const Kernel ball = smooth_cap(5, 1, 0.4);
  for (const double angle : {0.0, 0.05}) {
    const PlacedBody lower{"a", &ball, turn(angle, {1, 0.3, 0})},
        upper{"b", &ball, upside_down(), 2.001 * up};
    const auto apart = true_distance(lower, upper, freely);
    EXPECT_NEAR(apart->distance, 0.001, 1.5e-4);
    EXPECT_NEAR(apart->element, 0.16, 0.04);
  }
  EXPECT_FALSE(true_distance(a, b, {"a", "b", up, {}, {}}));
}

}  // namespace creases_test
