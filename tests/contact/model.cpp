// SPDX-License-Identifier: BSD-2-Clause
// The joint system of several bodies, compared with rows derived by hand.
#include "contact/model/model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "kernels/algebra.hpp"
#include "tests/contact/bodies.hpp"
#include "tests/contact/heap_counter.hpp"

namespace model_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;

constexpr double round_off = 1e-14;  // a few operations on numbers of order 1
const Vector3d up(0, 0, 1);

/// Matrix of reproducible, irregular numbers of order 1.
Matrix numbers(int rows, int columns, double seed) {
  Matrix out(rows, columns);
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) out(i, j) = std::sin(seed + 1.7 * i + 0.9 * j * j + 0.3);
  return out;
}
std::vector<double> flat(const Matrix& x) { return {x.data(), x.data() + x.size()}; }

/// Adds `modes` modes with arbitrary traces on the existing candidates.
void give_modes(Kernel& kernel, int modes, double seed, bool residual) {
  const int rows = kernel.surface.components * static_cast<int>(kernel.surface.size());
  for (int n = 0; n < modes; ++n) {
    kernel.modes.angular_frequency.push_back(10.0 * (n + 1));
    kernel.modes.decay_rate.push_back(0.1 * (n + 1));
  }
  kernel.surface.shape = flat(numbers(rows, modes, seed));
  if (residual) {
    const Matrix half = numbers(rows, rows, seed + 5);
    kernel.surface.residual_flexibility = flat(Matrix(half * half.transpose()));
    kernel.loads.body_force_residual = flat(numbers(rows, 3, seed + 7));
  }
  kernel.loads.body_force = flat(numbers(3, modes, seed + 1));
  kernel.loads.rotation = flat(numbers(3, modes, seed + 2));
}

/// A body with a lower candidate (0) and an upper candidate (1), 2 m apart.
Kernel ball(double seed, int components = 3, bool residual = true) {
  Kernel kernel;
  kernel.mass = 2;
  add_candidate(kernel, -up, -up, 1e-4);
  add_candidate(kernel, up, up, 2e-4);
  kernel.surface.element_corners = 1;
  kernel.surface.element = {0, 1};
  kernel.surface.components = components;
  if (components == 1) kernel.surface.direction = ricochet::Vector3{0, 0, 1};
  give_modes(kernel, 2, seed, residual);
  return kernel;
}

/// Value of mode shape `mode` for one component of one candidate.
double shape(const Kernel& kernel, int candidate, int component, int mode) {
  return kernel.surface.shape[static_cast<std::size_t>((3 * candidate + component) * 2 + mode)];
}
double residual_zz(const Kernel& kernel, int i, int j) {
  const int c = kernel.surface.components, rows = 2 * c;
  return kernel.surface
      .residual_flexibility[static_cast<std::size_t>((c * i + c - 1) * rows + c * j + c - 1)];
}

TEST(Normals, suffice_for_pairs_that_are_not_tilted_against_them) {
  const Kernel all = ball(1), normal = ricochet::kernels::restricted_to_normals(all);
  const auto built = [](const Kernel& kernel, double tilt) {
    PlacedBody body{.name = "ball", .kernel = &kernel};
    body.rotation = Eigen::AngleAxisd(tilt, Vector3d::UnitX()).toRotationMatrix();
    return build_model({body}, {{"ceiling", Vector3d(0, 0, 2), -up}}, {{"ball", "ceiling", {}, {}, {}}},
                       Vector3d(0, 0, -9.81));
  };
  const Model expected = built(all, 0), found = built(normal, 0);
  EXPECT_EQ(found.B, expected.B);
  EXPECT_LT((found.R - expected.R).norm(), round_off * expected.R.norm());
  EXPECT_LT((found.static_displacement - expected.static_displacement).norm(),
            round_off * expected.static_displacement.norm());
  EXPECT_NO_THROW(built(normal, 0.9 * most_tilt));
  EXPECT_NO_THROW(built(all, 1.1 * most_tilt));
  const std::string line = complaint_of([&] { built(normal, 1.1 * most_tilt); });
  EXPECT_THAT(line, HasSubstr("holds the residual flexibility along its own normals alone"));
  EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 0);
}

TEST(Rows, hold_a_outward_and_b_weighted_and_opposite) {
  // b is one triangle above that faces down. Its point opposite a's upper candidate has the
  // barycentric coordinates 0.2, 0.3, 0.5.
  Kernel a = ball(1), b;
  b.mass = 1;
  add_candidate(b, {0, 0, 0}, -up, 1);
  add_candidate(b, {1, 0, 0}, -up, 1);
  add_candidate(b, {0, 1, 0}, -up, 1);
  b.surface.element = {0, 1, 2};
  give_modes(b, 2, 3, false);
  const double weight[3] = {0.2, 0.3, 0.5};
  const Model model =
      build_model({{"a", &a, turn(0.4, up), {0.3, 0.5, 0}}, {"b", &b, Matrix3d::Identity(), 1.1 * up}}, {},
                  {{"a", "b", up, {}, {}}}, Vector3d::Zero());
  ASSERT_EQ(model.B.rows(), 1);
  ASSERT_EQ(model.B.cols(), 4);
  EXPECT_NEAR(model.gap(0), 0.1, round_off);
  EXPECT_EQ(model.area(0), 2e-4);
  EXPECT_EQ(model.pairs[0].unpaired, 1);
  for (int n = 0; n < 2; ++n) {
    EXPECT_NEAR(model.B(0, n), shape(a, 1, 2, n), round_off);  // rotation about z does not change z
    double expected = 0;
    for (int j = 0; j < 3; ++j) expected -= weight[j] * shape(b, j, 2, n);
    EXPECT_NEAR(model.B(0, 2 + n), expected, round_off);
    EXPECT_EQ(model.omega(2 + n), 10.0 * (n + 1));
    EXPECT_EQ(model.decay(n), 0.1 * (n + 1));
  }
}

TEST(Rows, follow_the_rotation_of_a_body) {
  // a lies on its side: its x axis points up in the world, and so does the normal of its candidate.
  Kernel a, wall;
  a.mass = 1;
  add_candidate(a, {1, 0, 0}, {1, 0, 0}, 1);
  a.surface.element_corners = 1;
  a.surface.element = {0};
  give_modes(a, 2, 1, false);
  const Matrix3d lying = turn(-std::numbers::pi / 2, {0, 1, 0});
  const Model model = build_model({{"a", &a, lying, Vector3d::Zero()}}, {{"ceiling", 1.5 * up, -up}},
                                  {{"a", "ceiling", {}, {}, {}}}, Vector3d::Zero());
  EXPECT_NEAR(model.gap(0), 0.5, round_off);
  for (int n = 0; n < 2; ++n) EXPECT_NEAR(model.B(0, n), shape(a, 0, 0, n), round_off);
}

/// Two bodies on a floor: pairs low–floor and high–low with one point each, both
/// along −z. `low` belongs to both pairs.
struct Stack {
  Kernel low, high;
  Model model;
  Stack(int components, const Vector3d& gravity, const Matrix3d& rotation = Matrix3d::Identity())
      : low(ball(1, components)), high(ball(2, components)) {
    const std::optional<Vector3d> down = -up;
    model = build_model({{"high", &high, Matrix3d::Identity(), 4 * up}, {"low", &low, rotation, 1.5 * up}},
                        {{"floor", Vector3d::Zero(), up}},
                        {{"low", "floor", {}, {}, {}}, {"high", "low", down, {}, {}}}, gravity);
  }
};

TEST(Residual, of_a_shared_body_couples_its_pairs) {
  for (const int components : {1, 3}) {
    const Stack stack(components, Vector3d::Zero());
    const Matrix& R = stack.model.R;
    ASSERT_EQ(R.rows(), 2);
    EXPECT_TRUE(stack.model.has_residual);
    // Point 0: u = −z of the lower end of low. Point 1: u = −z of the lower end
    // of high plus z of the upper end of low.
    EXPECT_NEAR(R(0, 0), residual_zz(stack.low, 0, 0), round_off);
    EXPECT_NEAR(R(1, 1), residual_zz(stack.high, 0, 0) + residual_zz(stack.low, 1, 1), round_off);
    EXPECT_NEAR(R(0, 1), -residual_zz(stack.low, 0, 1), round_off);
    EXPECT_EQ(R(1, 0), R(0, 1));
    const Matrix& R_a = stack.model.R_a;  // rows: low at point 0, high at point 1
    EXPECT_NEAR(R_a(0, 0), R(0, 0), round_off);
    EXPECT_NEAR(R_a(0, 1), R(0, 1), round_off);
    EXPECT_EQ(R_a(1, 0), 0);
    EXPECT_NEAR(R_a(1, 1), residual_zz(stack.high, 0, 0), round_off);
  }
}

TEST(Rows, are_filled_again_without_memory) {
  const Stack stack(3, Vector3d(0.5, -1, -9.81));
  Rows rows = stack.model;
  for (Matrix* x : {&rows.B, &rows.R, &rows.R_a}) x->setConstant(7);
  for (Vector* x : {&rows.static_displacement, &rows.static_a}) x->setConstant(7);
  const long before = heap_counter::calls;
  fill(rows, stack.model);
  EXPECT_EQ(heap_counter::calls, before);
  EXPECT_EQ(rows.B, stack.model.B);
  EXPECT_EQ(rows.R, stack.model.R);
  EXPECT_EQ(rows.R_a, stack.model.R_a);
  EXPECT_EQ(rows.static_displacement, stack.model.static_displacement);
  EXPECT_EQ(rows.static_a, stack.model.static_a);
}

TEST(Residual, of_bodies_upside_down_is_the_same) {
  const Stack upright(1, Vector3d::Zero()), turned(1, Vector3d::Zero(), upside_down());
  // In the inverted body, the candidates are exchanged.
  EXPECT_NEAR(turned.model.R(0, 0), residual_zz(turned.low, 1, 1), round_off);
  EXPECT_NEAR(turned.model.R(0, 1), upright.model.R(0, 1), round_off);
  // A displacement along −z of the world is one along +z of the body.
  for (int n = 0; n < 2; ++n)
    EXPECT_NEAR(turned.model.B(0, 2 + n), turned.low.surface.shape[static_cast<std::size_t>(2 + n)],
                round_off);
}

TEST(Residual, is_not_claimed_when_one_body_has_none) {
  const Kernel low = ball(1), high = ball(2, 3, false);
  const Model model = build_model(
      {{"high", &high, Matrix3d::Identity(), 4 * up}, {"low", &low, Matrix3d::Identity(), 1.5 * up}}, {},
      {{"high", "low", -up, {}, {}}}, Vector3d::Zero());
  EXPECT_FALSE(model.has_residual);
  EXPECT_NEAR(model.R(0, 0), residual_zz(low, 1, 1), round_off);
}

TEST(Gravity, loads_the_modes_and_settles_the_modes_left_out) {
  const Vector3d gravity(0.5, -1, -9.81);
  const Stack stack(3, gravity, upside_down());
  const Vector3d in_low(0.5, 1, 9.81);
  const auto settled = [&](const Kernel& kernel, int candidate, const Vector3d& g) {
    double sum = 0;
    for (int k = 0; k < 3; ++k)
      sum += kernel.loads.body_force_residual[static_cast<std::size_t>((3 * candidate + 2) * 3 + k)] * g(k);
    return sum;
  };
  for (int n = 0; n < 2; ++n) {
    double f = 0;
    for (int k = 0; k < 3; ++k)
      f += stack.low.loads.body_force[static_cast<std::size_t>(2 * k + n)] * in_low(k);
    EXPECT_NEAR(stack.model.load(2 + n), f, 1e-13);  // numbers of order 10
  }
  // The world's −z is +z of low, whose upper candidate (1) is at the bottom.
  EXPECT_NEAR(stack.model.static_displacement(0), settled(stack.low, 1, in_low), 1e-13);
  const double high = -settled(stack.high, 0, gravity);
  EXPECT_NEAR(stack.model.static_displacement(1), high - settled(stack.low, 0, in_low), 1e-13);
  EXPECT_NEAR(stack.model.static_a(1), high, 1e-13);
}

/// Mass 2 with its centre at (1, 2, 3), three translations and one
/// elastic mode. If supported, no mode is rigid.
Kernel lump(bool supported) {
  Kernel kernel = ball(1);
  kernel.supported = supported;
  kernel.centre = {1, 2, 3};
  kernel.inertia = {3, 0.1, 0.2, 0.1, 4, 0.3, 0.2, 0.3, 5};
  const double root = std::sqrt(kernel.mass);
  kernel.modes.angular_frequency = {supported ? 1.0 : 0, supported ? 2.0 : 0, supported ? 3.0 : 0, 50};
  kernel.modes.decay_rate = {0, 0, 0, 0};
  kernel.surface.shape = flat(numbers(6, 4, 1));
  kernel.loads.body_force = {root, 0, 0, 0, 0, root, 0, 0, 0, 0, root, 0};
  // L = centre × p, one column for each translation.
  kernel.loads.rotation = {0, -3 * root, 2 * root, 0, 3 * root, 0, -root, 0, -2 * root, root, 0, 0};
  return kernel;
}

Model thrown(const Kernel& kernel, const Vector3d& velocity) {
  return build_model({{"lump", &kernel, turn(0.8, {1, -1, 2}), 9 * up, velocity}},
                     {{"floor", Vector3d::Zero(), up}}, {{"lump", "floor", {}, {}, {}}}, Vector3d::Zero());
}

TEST(Bodies, carry_their_momenta_into_the_world) {
  const Kernel kernel = lump(false);
  const Vector3d v(3, -1, 2);
  const Model model = thrown(kernel, v);
  const Bodies::Block& body = model.bodies[0];
  const Matrix3d Q = turn(0.8, {1, -1, 2});
  EXPECT_LT((body.centre - (Q * Vector3d(1, 2, 3) + 9 * up)).norm(), 1e-13);
  EXPECT_LT((body.momentum * model.v0 - 2 * v).norm(), 1e-13);
  EXPECT_LT((body.angular_momentum * model.v0 - body.centre.cross(2 * v)).norm(), 1e-12);
  EXPECT_EQ(model.v0(3), 0);
  EXPECT_NEAR(0.5 * model.v0.squaredNorm(), 0.5 * 2 * v.squaredNorm(), 1e-13);
  EXPECT_NEAR(body.inertia.trace(), 12, 1e-13);  // invariant under rotation
  const Vector3d axis = Q * Vector3d(1, 0, 0);
  EXPECT_NEAR(axis.dot(body.inertia * axis), 3, 1e-13);
}

TEST(Bodies, that_are_supported_can_not_be_thrown) {
  const Kernel kernel = lump(true);
  EXPECT_THAT(complaint_of([&] {
                thrown(kernel, {0, 0, 1});
              }),
              HasSubstr("bodies.lump.velocity: a supported body cannot move rigidly"));
  EXPECT_EQ(thrown(kernel, Vector3d::Zero()).v0.norm(), 0);
}

TEST(Bodies, that_hold_one_axis_alone_can_not_be_thrown_along_another) {
  const Kernel kernel = rod(3, 10);
  EXPECT_THAT(complaint_of([&] {
                build_model({{"rod", &kernel, Matrix3d::Identity(), Vector3d::Zero(), {1, 0.1, 0}}},
                            {{"wall", Vector3d(11, 0, 0), Vector3d(-1, 0, 0)}}, {{"rod", "wall", {}, {}, {}}},
                            Vector3d::Zero());
              }),
              HasSubstr("bodies.rod.velocity"));
}

TEST(Names, that_do_not_fit_are_refused) {
  const Kernel kernel = ball(1);
  const std::vector<PlacedBody> one{{"ball", &kernel, Matrix3d::Identity(), 3 * up}};
  const std::vector<Obstacle> floor{{"floor", Vector3d::Zero(), up}};
  const auto build = [&](std::vector<PlacedBody> bodies, const PairRequest& request) {
    return complaint_of([&] { build_model(bodies, floor, {request}, Vector3d::Zero()); });
  };
  EXPECT_THAT(build(one, {"bal", "floor", {}, {}, {}}), HasSubstr("\"bal\" is not a body"));
  EXPECT_THAT(build(one, {"ball", "flor", {}, {}, {}}), HasSubstr("\"flor\" is neither"));
  EXPECT_THAT(build(one, {"ball", "ball", {}, {}, {}}), HasSubstr("cannot meet itself"));
  EXPECT_THAT(build({one[0], {"idle", &kernel}}, {"ball", "floor", {}, {}, {}}),
              HasSubstr("bodies.idle: no pair names it"));
}

TEST(Gaps, of_two_pairs_place_both_bodies) {
  const Kernel low = ball(1), high = ball(2);
  const Model model = build_model(
      {{"high", &high, Matrix3d::Identity(), 40 * up}, {"low", &low, Matrix3d::Identity(), 15 * up}},
      {{"floor", Vector3d::Zero(), up}}, {{"low", "floor", {}, 0.1, {}}, {"high", "low", -up, 0.2, {}}},
      Vector3d::Zero());
  EXPECT_NEAR(model.gap(0), 0.1, round_off);
  EXPECT_NEAR(model.gap(1), 0.2, round_off);
  EXPECT_NEAR(model.point_a(1, 2), 2.3, round_off);
  EXPECT_NEAR(model.bodies[0].translation.z(), 3.3, round_off);
}

// The contact lies at the origin and the centre of the body a metre above it.
// Gaps have the round-off of this distance.
TEST(Gaps, may_be_as_small_as_one_likes) {
  const Kernel one = ball(1);
  for (const double gap : {0.0, 1.557176905742086e-7, 1.5916132835025465e-8, 3.3e-10, 1e-15}) {
    const Model model =
        build_model({{"one", &one, Matrix3d::Identity(), 7.3 * up}}, {{"floor", Vector3d::Zero(), up}},
                    {{"one", "floor", {}, gap, {}}}, Vector3d::Zero());
    EXPECT_NEAR(model.gap.minCoeff(), gap, round_off);
  }
}

TEST(Gaps, that_one_body_can_not_serve_together_are_refused) {
  const Kernel low = ball(1), high = ball(2);
  EXPECT_THAT(complaint_of([&] {
                build_model({{"high", &high, Matrix3d::Identity(), 4 * up},
                             {"low", &low, Matrix3d::Identity(), 1.5 * up}},
                            {{"floor", Vector3d::Zero(), up}},
                            {{"high", "low", -up, 0.2, {}}, {"low", "floor", {}, 0.1, {}}}, Vector3d::Zero());
              }),
              HasSubstr("another pair's gap moves one of them to 0.6 m"));
}

}  // namespace model_test
