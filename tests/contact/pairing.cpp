// SPDX-License-Identifier: BSD-2-Clause
// Surface projection from points to opposite points: flat sheets, spheres, rims of disks, rods, half-spaces.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "tests/contact/bodies.hpp"

namespace pairing_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;

constexpr double round_off = 1e-14;  // a few operations on numbers of order 1
const Vector3d up(0, 0, 1);

PairRequest along(const Vector3d& direction) { return {"a", "b", direction, {}, {}}; }
const PairRequest freely{"a", "b", {}, {}, {}};

/// b above a, facing down, over the unit square.
PlacedBody above(const Kernel& kernel, double height) {
  return {"b", &kernel, upside_down(), Vector3d(0, 1, height), Vector3d::Zero()};
}

Vector3d weighted_node(const Pairing::Point& point, const PlacedBody& b) {
  Vector3d sum = Vector3d::Zero();
  for (const auto& [j, w] : point.of_b)
    sum += w * (b.rotation * Eigen::Map<const Vector3d>(&b.kernel->surface.node[3 * j]) + b.translation);
  return sum;
}

TEST(FlatSheets, unlike_meshes_pair_exactly) {
  const Kernel lower = square(5, 4), upper = square(7, 3);
  const PlacedBody a{"a", &lower}, b = above(upper, 0.3);
  for (const PairRequest& request : {along(up), freely}) {
    const Pairing pairing = pair(a, b, request);
    EXPECT_EQ(pairing.unpaired, 0);
    ASSERT_EQ(pairing.points.size(), lower.surface.size());
    for (const auto& point : pairing.points) {
      EXPECT_NEAR(point.gap, 0.3, round_off);
      EXPECT_LT((point.normal - up).norm(), round_off);
      EXPECT_LT((point.b - point.a - 0.3 * up).norm(), round_off);
      EXPECT_EQ(point.area, lower.surface.area[point.of_a[0].first]);
      double sum = 0;
      for (const auto& [j, w] : point.of_b) {
        EXPECT_GE(w, 0);
        sum += w;
      }
      EXPECT_NEAR(sum, 1, round_off);
      // Positions are linear fields themselves, so the weights map the nodes of b to the point opposite a.
      EXPECT_LT((weighted_node(point, b) - point.a - 0.3 * up).norm(), round_off);
    }
  }
}

TEST(FlatSheets, pair_the_same_wherever_the_bodies_are_placed) {
  const Kernel lower = square(5, 4), upper = square(7, 3);
  const PlacedBody a{"a", &lower}, b = above(upper, 0.3);
  const Matrix3d Q = turn(0.7, {1, 2, -0.5});
  const Vector3d t(3, -4, 5);
  const auto moved = [&](PlacedBody body) {
    body.rotation = Q * body.rotation;
    body.translation = Q * body.translation + t;
    return body;
  };
  const Pairing here = pair(a, b, along(up));
  for (const PairRequest& request : {along(Q * up), freely}) {
    const Pairing there = pair(moved(a), moved(b), request);
    ASSERT_EQ(there.points.size(), here.points.size());
    for (std::size_t i = 0; i < here.points.size(); ++i) {
      // 1e-13: coordinates of order 10
      EXPECT_NEAR(there.points[i].gap, 0.3, 1e-13);
      EXPECT_LT((there.points[i].normal - Q * up).norm(), 1e-13);
      EXPECT_LT((there.points[i].b - (Q * here.points[i].b + t)).norm(), 1e-13);
    }
  }
}

TEST(FlatSheets, candidates_beside_the_other_body_are_dropped_and_counted) {
  const Kernel lower = square(4, 4), upper = square(3, 3);
  PlacedBody b = above(upper, 0.1);
  b.translation.x() = 0.5;  // b covers x ≥ 0.5: columns 0.5, 0.75 and 1 of five
  const Pairing pairing = pair({"a", &lower}, b, along(up));
  EXPECT_EQ(pairing.points.size(), 15U);
  EXPECT_EQ(pairing.unpaired, 10);
}

TEST(FlatSheets, backs_face_nothing) {
  const Kernel lower = square(2, 2), upper = square(2, 2);
  const PlacedBody a{"a", &lower}, back{"b", &upper, Matrix3d::Identity(), 0.1 * up};
  EXPECT_THAT(complaint_of([&] { pair(a, back, along(up)); }), HasSubstr("no point of \"a\" faces \"b\""));
  EXPECT_THAT(complaint_of([&] { pair(a, back, freely); }), HasSubstr("no point of \"a\" faces \"b\""));
  EXPECT_THAT(complaint_of([&] { pair(a, above(upper, 0.1), along(-up)); }), HasSubstr("contact.direction"));
}

/// A thick body consists of two sheets 1 m apart, one behind the other, in either order in the kernel.
TEST(FlatSheets, the_nearer_of_two_facing_sheets_is_met) {
  const Kernel lower = square(2, 2);
  for (const bool near_first : {true, false}) {
    Kernel stack = square(3, 3);
    const Kernel other = stack;
    const auto first = static_cast<std::int64_t>(stack.surface.size());
    for (std::size_t i = 0; i < other.surface.size(); ++i)  // upside down, a sheet at −z is farther away
      add_candidate(
          stack, {other.surface.node[3 * i], other.surface.node[3 * i + 1], near_first ? -1.0 : 1.0}, up, 1);
    for (const std::int64_t corner : other.surface.element) stack.surface.element.push_back(first + corner);
    const double nearest = 0.2;
    for (const auto& point :
         pair({"a", &lower}, above(stack, near_first ? nearest : nearest + 1), along(up)).points)
      EXPECT_NEAR(point.gap, nearest, round_off);
  }
}

TEST(FlatSheets, a_place_just_beyond_the_edge_is_taken_at_the_edge) {
  const Kernel lower = square(2, 2),
               upper = square(2, 3);  // some points also lie beside the middle of an edge
  PlacedBody b = above(upper, 0.1);
  b.translation.x() = 5e-7;  // elements have a size of 0.7 m, of which 1e-6 is tolerated
  const Pairing met = pair({"a", &lower}, b, along(up));
  EXPECT_EQ(met.unpaired, 0);
  for (const auto& point : met.points) {
    double sum = 0;
    for (const auto& [j, w] : point.of_b) sum += w;
    EXPECT_NEAR(sum, 1, round_off);
    EXPECT_LT((weighted_node(point, b) - point.b).norm(), round_off);
    EXPECT_GE(point.b.x(), 5e-7);
  }
  b.translation.x() = 5e-6;
  EXPECT_EQ(pair({"a", &lower}, b, along(up)).unpaired, 3);
}

TEST(Spheres, equal_ones_meet_in_their_mirror_plane) {
  const Kernel sphere = cap(8, 1, 0.5);
  const double height =
      2.5;  // height of the centre of b, which is the mirror image of a in the plane z = 1.25
  const Pairing pairing = pair({"a", &sphere}, {"b", &sphere, upside_down(), height * up}, freely);
  EXPECT_EQ(pairing.unpaired, 0);
  for (const auto& point : pairing.points) {
    // 1e-9: the iteration stops when normals change by less than 1e-13; it converges with a rate below 0.6
    EXPECT_LT((point.normal - up).norm(), 1e-9);
    EXPECT_NEAR(point.gap, height - 2 * point.a.z(), 1e-9);
  }
}

TEST(Spheres, unlike_ones_have_the_normal_between_theirs) {
  const Kernel small = cap(6, 1, 0.3), big = cap(40, 3, 0.3);
  const Vector3d centre = 4.2 * up;
  const Pairing pairing = pair({"a", &small}, {"b", &big, upside_down(), centre}, freely);
  EXPECT_EQ(pairing.unpaired, 0);
  const double h = 3 * 0.6 / 40;
  for (const auto& point : pairing.points) {
    EXPECT_LT((point.b - point.a - point.gap * point.normal).norm(), 1e-12);
    // Facets lie inside the sphere by at most h²/4R for triangles whose longest edge is √2 h.
    EXPECT_LE((point.b - centre).norm(), 3 + 1e-12);
    EXPECT_GE((point.b - centre).norm(), 3 - h * h / 4 / 3);
    const Vector3d n_a = point.a, n_b = (point.b - centre).normalized();
    EXPECT_LT((point.normal - (n_a - n_b).normalized()).norm(), h * h);
  }
}

/// Half of the rim of a disk, with `intervals` + 1 candidates: strips across the thickness.
Kernel half_rim(double thickness_offset, bool lower_half, int intervals) {
  Kernel kernel;
  kernel.mass = 1;
  kernel.surface.element_corners = 2;
  for (std::int64_t k = 0; k <= intervals; ++k) {
    const double angle = static_cast<double>(k) * std::numbers::pi / intervals * (lower_half ? -1 : 1);
    const Vector3d way(std::cos(angle), std::sin(angle), 0);
    add_candidate(kernel, 0.05 * way + Vector3d(0, 0, thickness_offset), way, 1e-4);
    if (k > 0) kernel.surface.element.insert(kernel.surface.element.end(), {k - 1, k});
  }
  return kernel;
}

TEST(Rims, all_positions_pair_the_ends_too) {
  const Kernel upper = half_rim(0, true, 16), lower = half_rim(1e-3, false, 16);
  PairRequest request = along({0, -1, 0});
  request.gap = 0.01;
  const Pairing pairing = pair({"a", &upper, Matrix3d::Identity(), {0, 0.3, 0}}, {"b", &lower}, request);
  EXPECT_EQ(pairing.unpaired, 0);
  ASSERT_EQ(pairing.points.size(), 17U);
  for (const auto& point : pairing.points) {
    const double angle = point.of_a[0].first * std::numbers::pi / 16;
    EXPECT_NEAR(point.gap, 0.01 + 0.1 * (1 - std::sin(angle)), 1e-15);
    ASSERT_FALSE(point.of_b.empty());
    const auto heaviest = std::max_element(point.of_b.begin(), point.of_b.end(),
                                           [](auto p, auto q) { return p.second < q.second; });
    EXPECT_EQ(heaviest->first, point.of_a[0].first);
    EXPECT_NEAR(heaviest->second, 1,
                1e-11);  // the last segment is seen nearly edge on: round-off divided by 0.02
  }
}

TEST(Rims, a_strip_beside_the_other_body_faces_nothing) {
  const Kernel upper = half_rim(0, true, 16), beside = half_rim(7e-3, false, 16);  // segments are 9.8 mm long
  EXPECT_THAT(complaint_of([&] {
                pair({"a", &upper, Matrix3d::Identity(), {0, 0.3, 0}}, {"b", &beside}, along({0, -1, 0}));
              }),
              HasSubstr("no point"));
}

TEST(Rods, ends_that_face_each_other_pair) {
  const Kernel kernel = rod(2, 10);
  for (const double gap : {0.0, 0.5}) {
    const PlacedBody a{"a", &kernel}, b{"b", &kernel, Matrix3d::Identity(), {10 + gap, 0, 0}};
    const Pairing pairing = pair(a, b, along({1, 0, 0}));
    ASSERT_EQ(pairing.points.size(), 1U);
    EXPECT_EQ(pairing.unpaired, 1);
    EXPECT_EQ(pairing.points[0].of_a[0].first, 1);
    EXPECT_EQ(pairing.points[0].gap, gap);
    EXPECT_EQ(pairing.points[0].of_b, (std::vector<std::pair<int, double>>{{0, 1.0}}));
  }
}

TEST(Rods, ends_beside_each_other_do_not_pair) {
  const Kernel kernel = rod(2, 10);
  EXPECT_THAT(complaint_of([&] {
                pair({"a", &kernel}, {"b", &kernel, Matrix3d::Identity(), {10.5, 1e-3, 0}}, along({1, 0, 0}));
              }),
              HasSubstr("no point"));
}

TEST(OneComponent, serves_its_own_line_in_both_senses_and_no_other) {
  const Kernel kernel = rod(2, 10);
  const PlacedBody a{"a", &kernel}, turned{"b", &kernel, turn(std::numbers::pi, up), {20.5, 0, 0}};
  EXPECT_EQ(pair(a, turned, along({1, 0, 0})).points[0].of_b[0].first, 1);
  const std::string tilted = complaint_of([&] { pair(a, turned, along(Vector3d(1, 1e-3, 0).normalized())); });
  EXPECT_THAT(tilted, HasSubstr("the kernel of \"a\" holds the motion along [1, 0, 0] alone"));
  EXPECT_THAT(complaint_of([&] { pair(a, turned, freely); }), HasSubstr("Set contact.direction = [1, 0, 0]"));
  EXPECT_THAT(complaint_of([&] {
                pair(a, Obstacle{"floor", Vector3d::Zero(), up}, freely);
              }),
              HasSubstr("alone"));
}

TEST(HalfSpaces, every_point_that_looks_at_one_meets_its_foot) {
  const Kernel kernel = cap(6, 1);
  const Obstacle floor{"floor", {7, 8, -2}, up};
  const Pairing pairing = pair({"a", &kernel, upside_down(), Vector3d::Zero()}, floor, freely);
  EXPECT_EQ(pairing.unpaired, 0);
  for (const auto& point : pairing.points) {
    EXPECT_EQ(point.normal, -up);
    EXPECT_NEAR(point.gap, point.a.z() + 2, round_off);
    EXPECT_LT((point.b - Vector3d(point.a.x(), point.a.y(), -2)).norm(), round_off);
    EXPECT_TRUE(point.of_b.empty());
  }
  EXPECT_THAT(complaint_of([&] { pair({"a", &kernel}, floor, freely); }), HasSubstr("no point"));
  EXPECT_THAT(complaint_of([&] {
                pair({"a", &kernel, upside_down(), Vector3d::Zero()}, floor, along({1, 0, 0}));
              }),
              HasSubstr("[-0, -0, -1]"));
}

TEST(Gap, moves_a_until_the_closest_pair_has_it) {
  const Kernel small = cap(6, 1, 0.3), big = cap(20, 3, 0.3);
  for (const double start : {3.0, 4.0, 4.5})  // overlapping, touching, apart
    for (const auto& direction : {std::optional<Vector3d>(up), std::optional<Vector3d>()}) {
      const PairRequest request{"a", "b", direction, 0.01, {}};
      const PlacedBody a{"a", &small}, b{"b", &big, upside_down(), start * up};
      const Pairing pairing = pair(a, b, request);
      double nearest = 1;
      for (const auto& point : pairing.points) nearest = std::min(nearest, point.gap);
      EXPECT_NEAR(nearest, 0.01, 1e-11) << start;  // 1e-12 for bodies of about a metre, and their distance
      // The poles are the closest points, and both are candidates.
      EXPECT_LT((pairing.shift - (start - 4 - 0.01) * up).norm(), 1e-9) << start;
    }
}

/// Two sheets as one surface.
Kernel joined(Kernel one, const Kernel& other) {
  ricochet::kernels::Surface& to = one.surface;
  const ricochet::kernels::Surface& from = other.surface;
  for (const std::int64_t corner : from.element)
    to.element.push_back(corner + static_cast<std::int64_t>(to.size()));
  to.node.insert(to.node.end(), from.node.begin(), from.node.end());
  to.normal.insert(to.normal.end(), from.normal.begin(), from.normal.end());
  to.group.insert(to.group.end(), from.group.begin(), from.group.end());
  to.area.insert(to.area.end(), from.area.begin(), from.area.end());
  return one;
}

/// A horizontal square, with x from `from` to `to`, and a vertical one at x = `wall`, with z from −1 to 0.
/// Their normals are `sense` times the axes.
Kernel corner_of(double from, double to, double z, double wall, double sense) {
  return joined(sheet(8, 4,
                      [=](double s, double t) {
                        return std::pair(Vector3d(from + (to - from) * s, t, z), Vector3d(0, 0, sense));
                      }),
                sheet(8, 4, [=](double s, double t) {
                  return std::pair(Vector3d(wall, t, s - 1), Vector3d(sense, 0, 0));
                }));
}

// A block under a ceiling, close to a wall. It moves along the mean normal, mostly upwards, which changes the
// gap to the wall by cos α of the way, α = 75°.
TEST(Gap, that_opens_obliquely_to_the_way_is_reached) {
  Kernel block = corner_of(-1, -0.5, 0, 0, 1);
  for (std::size_t i = 0; i < block.surface.size(); ++i)
    block.surface.area[i] = block.surface.normal[3 * i] > 0.5 ? std::cos(75 * std::numbers::pi / 180)
                                                              : std::sin(75 * std::numbers::pi / 180);
  const double gap = 0.02;
  for (const double start : {0.05, 0.03, 0.02, 0.01}) {
    const Kernel room = corner_of(-3, 0, 0.3, start, -1);
    const Pairing pairing = pair({"a", &block}, {"b", &room}, {"a", "b", {}, gap, {}});
    const double way = (start - gap) / std::cos(75 * std::numbers::pi / 180);
    const Vector3d expected = Vector3d(start - gap, 0, way * std::sin(75 * std::numbers::pi / 180));
    EXPECT_LT((pairing.shift - expected).norm(), 1e-10) << start;
    double nearest = 1;
    for (const auto& point : pairing.points) nearest = std::min(nearest, point.gap);
    EXPECT_NEAR(nearest, gap, 1e-11) << start;
  }
}

// Almost all of the surface faces the ceiling, and motion towards it does not change the gap to the wall.
TEST(Gap, that_does_not_change_along_the_way_is_refused) {
  Kernel block = corner_of(-1, -0.5, 0, 0, 1);
  for (std::size_t i = 0; i < block.surface.size(); ++i)
    if (block.surface.normal[3 * i] > 0.5) block.surface.area[i] *= 1e-5;
  const Kernel room = corner_of(-3, 0, 0.3, 0.05, -1);
  EXPECT_THAT(complaint_of([&] {
                pair({"a", &block}, {"b", &room}, {"a", "b", {}, 0.02, {}});
              }),
              HasSubstr("gap = 0.02 m cannot be reached by moving \"a\" along [1e-05, 0, 1]"));
}

TEST(Gap, of_zero_touches) {
  const Kernel small = cap(6, 1, 0.3);
  const Pairing pairing = pair({"a", &small, upside_down(), 1.7 * up},
                               Obstacle{"floor", Vector3d::Zero(), up}, {"a", "floor", {}, 0.0, {}});
  double nearest = 1;
  for (const auto& point : pairing.points) nearest = std::min(nearest, point.gap);
  EXPECT_EQ(nearest, 0);
  EXPECT_LT((pairing.shift + 0.7 * up).norm(), 1e-12);
}

TEST(Reach, drops_pairs_that_start_too_far_apart) {
  const Kernel kernel = cap(8, 1);
  const Obstacle wall{"wall", 1.1 * up, -up};
  const Pairing all = pair({"a", &kernel}, wall, freely);
  const Pairing near = pair({"a", &kernel}, wall, {"a", "wall", {}, {}, 0.15});
  const auto within =
      std::count_if(all.points.begin(), all.points.end(), [](auto& p) { return p.gap < 0.15; });
  EXPECT_GT(within, 1);
  EXPECT_LT(within, static_cast<long>(all.points.size()));
  EXPECT_EQ(static_cast<long>(near.points.size()), within);
  EXPECT_EQ(near.unpaired, static_cast<int>(all.points.size()) - static_cast<int>(within));
  EXPECT_THAT(complaint_of([&] {
                pair({"a", &kernel}, wall, {"a", "wall", {}, {}, 0.05});
              }),
              HasSubstr("the closest pair is 0.1 m apart"));
}

/// The kernel with patches whose centroids x̂ are offset from their nodes by up to
/// `far`, in the components selected by `way`.
Kernel lopsided(Kernel kernel, double far, const Vector3d& way) {
  kernel.surface.centroid = kernel.surface.node;
  for (std::size_t k = 0; k < kernel.surface.centroid.size(); ++k)
    kernel.surface.centroid[k] +=
        far * way(static_cast<Eigen::Index>(k % 3)) * std::sin(1.7 * static_cast<double>(k));
  kernel.surface.bulge.assign(kernel.surface.size(), 0);
  return kernel;
}

TEST(Centroids, of_patches_set_the_gap_to_a_wall) {
  const Kernel kernel = lopsided(cap(6, 1), 0.02, {1, 1, 1});
  const Matrix3d Q = turn(0.2, {1, 2, 0.5});
  const PlacedBody a{"a", &kernel, Q, {0.1, 0.2, 0.3}};
  const Pairing pairing = pair(a, Obstacle{"wall", 2 * up, -up}, {"a", "wall", {}, {}, {}});
  ASSERT_EQ(pairing.points.size(), kernel.surface.size());
  for (const auto& point : pairing.points) {
    const Vector3d mean = Q * Eigen::Map<const Vector3d>(&kernel.surface.centroid[3 * point.of_a[0].first]);
    EXPECT_NEAR(point.gap, 2 - 0.3 - mean.z(), round_off);
    EXPECT_NEAR(point.b.z(), 2, round_off);
  }
}

TEST(Centroids, of_patches_in_the_planes_of_flat_sheets_leave_the_gap_as_it_is) {
  const Kernel lower = lopsided(square(5, 4), 0.05, {1, 1, 0}),
               upper = lopsided(square(7, 3), 0.05, {1, 1, 0});
  // The direction is 30 degrees off the normal of the sheets, so motion
  // along the sheets has a component along it.
  const Matrix3d Q = turn(std::numbers::pi / 6, {1, 0, 0});
  const PlacedBody a{"a", &lower, Q};
  PlacedBody b = above(upper, 0.3);
  b.rotation = Q * b.rotation;
  b.translation = Q * b.translation;
  for (const PairRequest& request : {along(up), freely}) {
    const Pairing pairing = pair(a, b, request);
    EXPECT_GT(pairing.points.size(), 10U);
    for (const auto& point : pairing.points)
      EXPECT_NEAR(point.gap, 0.3 / (request.direction ? std::cos(std::numbers::pi / 6) : 1), round_off);
  }
}

// Files of version 1 have the means of patches instead of x̂ and the bulge.
TEST(Means, of_patches_beneath_their_nodes_count_as_their_bulge) {
  Kernel lower = square(3, 3), upper = square(4, 2);
  for (Kernel* kernel : {&lower, &upper}) {
    kernel->surface.centroid = kernel->surface.node;
    const double depth = kernel == &lower ? 0.01 : 0.02;
    for (std::size_t i = 0; i < kernel->surface.size(); ++i) kernel->surface.centroid[3 * i + 2] -= depth;
  }
  for (const auto& point : pair({"a", &lower}, above(upper, 0.3), freely).points) {
    EXPECT_NEAR(point.gap, 0.3, round_off);
    EXPECT_NEAR(point.bulge, 0.03, round_off);
  }
}

TEST(Bulges, of_both_patches_add_up_and_are_never_negative) {
  Kernel lower = square(3, 3), upper = square(4, 2);
  for (const auto& [a, b, sum] :
       {std::tuple(0.01, 0.02, 0.03), std::tuple(0.03, -0.01, 0.02), std::tuple(0.01, -0.02, 0.0)}) {
    lower.surface.bulge.assign(lower.surface.size(), a);
    upper.surface.bulge.assign(upper.surface.size(), b);
    for (const auto& point : pair({"a", &lower}, above(upper, 0.3), freely).points) {
      EXPECT_NEAR(point.gap, 0.3, round_off);
      EXPECT_NEAR(point.bulge, sum, round_off);
    }
    for (const auto& point : pair({"a", &lower}, Obstacle{"wall", up, -up}, freely).points)
      EXPECT_NEAR(point.bulge, std::max(a, 0.0), round_off);
  }
}

// 1e-12 of the bodies' size, here √2 m, is round-off.
TEST(Overlap, is_refused_with_its_depth_from_ten_times_round_off_and_is_touching_below) {
  const Kernel lower = square(2, 2), upper = square(2, 2);
  for (const PairRequest& request : {along(up), freely}) {
    EXPECT_THAT(complaint_of([&] {
                  pair({"a", &lower}, above(upper, -3e-11), request);
                }),
                AllOf(HasSubstr("overlap by 3e-11 m"), HasSubstr("contact.gap")));
    for (const auto& point : pair({"a", &lower}, above(upper, -3e-13), request).points)
      EXPECT_EQ(point.gap, 0);
  }
}

/// A square drawn 1e6 m from the origin of its own frame. After a
/// rotation, its positions are known to 1e-10 m.
Kernel far_away() {
  return sheet(3, 3, [](double s, double t) {
    return std::pair(Vector3d(1e6 + s, 1e6 + t, 1e6), Vector3d(0, 0, -1));
  });
}

TEST(Overlap, by_round_off_of_places_far_from_the_origin_is_touching) {
  const Kernel kernel = far_away();
  for (const double angle : {0.1, 0.5, 1.0, 2.0, 3.0}) {
    const Pairing pairing = pair({"a", &kernel, turn(angle, up)}, Obstacle{"floor", 1e6 * up, up}, freely);
    for (const auto& point : pairing.points) EXPECT_LT(point.gap, 1e-8) << angle;
  }
}

TEST(Overlap, far_from_the_origin_is_refused_where_it_is_more_than_round_off) {
  const Kernel kernel = far_away();
  const std::string text = complaint_of([&] {
    pair({"a", &kernel, turn(0.5, up)}, Obstacle{"floor", (1e6 + 1e-6) * up, up}, freely);
  });
  EXPECT_THAT(text, HasSubstr("overlap by"));
}

TEST(Gap, of_zero_is_reached_by_bodies_far_from_the_origin) {
  const Kernel kernel = far_away();
  const Matrix3d turned = turn(0.3, Vector3d(1, 2, 3));
  const Pairing pairing =
      pair({"a", &kernel, turned}, Obstacle{"floor", Vector3d::Zero(), up}, {"a", "floor", {}, 0.0, {}});
  double nearest = 1;
  for (const auto& point : pairing.points) nearest = std::min(nearest, point.gap);
  EXPECT_LT(nearest, 1e-8);
}

}  // namespace pairing_test
