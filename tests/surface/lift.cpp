// SPDX-License-Identifier: BSD-2-Clause
// Moving supports compared with dense solves and with closed forms of a rod.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "src/scene/request.hpp"
#include "tests/modes/dense.hpp"
#include "tests/surface/made.hpp"

namespace ricochet {
namespace lift_test {

using namespace test;

/// The block of the tests below. Its bottom moves and its top is fixed along
/// z, so that it is sheared and stretched.
scene::KernelRequest squeezed() {
  scene::KernelRequest request = request_of({"sides"}, {{"bottom", "xyz"}, {"top", "z"}});
  request.direction = Vector3{0.6, 0, 0.8};
  request.loads.motions = {load("bottom", "bottom"), load("top", "top")};
  request.loads.points = {load("tap", "", {1, 0.5, 0.5})};
  request.receivers = {receiver("mic", {0, 0.5, 0.5}), receiver("edge", {0, 0.5, 0})};
  return request;
}

/// Global number of the node at x; −1 if there is none.
std::int64_t node_at(const mesh::Mesh& mesh, const Point& x) {
  double found = -1;
  for (std::size_t i = 0; i < mesh.node.size(); ++i)
    if ((Point(&mesh.position[3 * i]) - x).norm() < 1e-9) found = static_cast<double>(mesh.node[i]);
  return static_cast<std::int64_t>(parallel::largest(mesh.comm, found));
}

// The oracle partitions the matrices of the body without supports and solves densely.
TEST(Lift, of_two_supports_is_that_of_a_dense_solve) {
  Made made(test::block_geo("hex", 2, 0), 2, squeezed());
  const kernels::Kernel kernel = made.kernel({.count = 12});
  mesh::Mesh free_mesh = made.mesh;
  for (std::int64_t& bits : free_mesh.fixed) bits = 0;
  const elasticity::Body free_body = elasticity::assemble(free_mesh, made.request.body.materials, "test");
  const MatrixXd K = test::dense(free_mesh, free_body, free_body.stiffness),
                 M = test::dense(free_mesh, free_body, free_body.mass);
  const Eigen::Index n = K.rows();
  // Columns: the bottom along x, y and z, and the top along z.
  MatrixXd psi = MatrixXd::Zero(n, 4);
  Eigen::VectorXd fixed = Eigen::VectorXd::Zero(n);
  for (std::size_t i = 0; i < made.mesh.node.size(); ++i) {
    const std::int64_t own = made.mesh.node[i] - made.mesh.first_node;
    if (own < 0 || own >= made.mesh.owned_nodes) continue;
    const double z = made.mesh.position[3 * i + 2];
    for (int k = 0; k < 3; ++k) {
      const Eigen::Index row = 3 * made.mesh.node[i] + k;
      if (z < 1e-9) psi(row, k) = fixed[row] = 1;
      if (z > 1 - 1e-9 && k == 2) psi(row, 3) = fixed[row] = 1;
    }
  }
  parallel::sum(PETSC_COMM_WORLD, psi);
  parallel::sum(PETSC_COMM_WORLD, fixed);
  std::vector<Eigen::Index> f;
  for (Eigen::Index i = 0; i < n; ++i)
    if (fixed[i] == 0) f.push_back(i);
  const MatrixXd pull = K * psi, solved = K(f, f).ldlt().solve(pull(f, Eigen::all));
  for (std::size_t i = 0; i < f.size(); ++i) psi.row(f[i]) -= solved.row(static_cast<Eigen::Index>(i));
  // All modes of the oracle. The kernel contains the lowest of them.
  const test::DenseModes oracle(PETSC_COMM_WORLD, K(f, f), M(f, f));
  MatrixXd phi = MatrixXd::Zero(n, static_cast<Eigen::Index>(kernel.modes.size()));
  for (std::size_t i = 0; i < f.size(); ++i)
    phi.row(f[i]) = oracle.vector.row(static_cast<Eigen::Index>(i)).leftCols(phi.cols());
  const MatrixXd gamma = phi.transpose() * M * psi, rest = psi - phi * gamma;

  // In these units all values are of order one. The modes are accurate to about their residuals, 1e-8.
  constexpr double tolerance = 1e-7;
  const auto expect_near = [&](const MatrixXd& found, const MatrixXd& exact) {
    ASSERT_EQ(found.rows(), exact.rows());
    ASSERT_EQ(found.cols(), exact.cols());
    EXPECT_LT((found - exact).cwiseAbs().maxCoeff(), tolerance);
  };
  const kernels::Motion &bottom = kernel.motions[0], &press = kernel.motions[1];
  MatrixXd participation(4, phi.cols());
  participation << rows(bottom.participation, 3), rows(press.participation, 3).row(2);
  // Modes of equal frequency are determined only up to rotation, which does not affect sums over them.
  const Eigen::VectorXd square = oracle.value.head(phi.cols());
  for (int power : {0, 1, 2}) {
    const Eigen::VectorXd weight = square.array().pow(-power);
    expect_near(participation * weight.asDiagonal() * participation.transpose(),
                gamma.transpose() * weight.asDiagonal() * gamma);
  }
  EXPECT_TRUE(rows(press.participation, 3).topRows(2).isZero(0));
  const std::int64_t places[] = {node_at(made.mesh, {0, 0.5, 0.5}), node_at(made.mesh, {0, 0.5, 0})};
  for (std::size_t r = 0; r < 2; ++r) {
    ASSERT_GE(places[r], 0);
    const MatrixXd exact = rest.middleRows(3 * places[r], 3);
    const MatrixXd found = rows(kernel.receivers[r].motion_residual, 3);
    expect_near(found.leftCols(3), exact.leftCols(3));
    expect_near(found.col(5), exact.col(3));
  }
  // Momentum, from products with translations.
  MatrixXd translations = MatrixXd::Zero(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) translations(i, i % 3) = 1;
  const MatrixXd momentum = translations.transpose() * M * rest;
  expect_near(rows(bottom.momentum, 3), momentum.leftCols(3));
  expect_near(rows(press.momentum, 3).col(2), momentum.col(3));
  // Candidates record a mean over their patch along the direction, with the weights of the patch.
  const Point direction(0.6, 0, 0.8);
  MatrixXd seen = MatrixXd::Zero(static_cast<Eigen::Index>(kernel.surface.size()), 4);
  for (const surface::Weight& weight : made.patches.weights)
    seen.row(weight.candidate) += weight.value * direction.transpose() * rest.middleRows(3 * weight.node, 3);
  expect_near(rows(bottom.residual, kernel.surface.size()), seen.leftCols(3));
  expect_near(rows(press.residual, kernel.surface.size()).col(2), seen.col(3));

  // A force at a node gives a column of the inverse of K.
  const std::int64_t tap = node_at(made.mesh, {1, 0.5, 0.5});
  MatrixXd unit = MatrixXd::Zero(n, 3);
  unit.middleRows(3 * tap, 3).setIdentity();
  const MatrixXd answer = K(f, f).ldlt().solve(unit(f, Eigen::all));
  MatrixXd displaced = MatrixXd::Zero(n, 3);
  for (std::size_t i = 0; i < f.size(); ++i) displaced.row(f[i]) = answer.row(static_cast<Eigen::Index>(i));
  const kernels::Receiver& mic = kernel.receivers[0];
  expect_near(modal(kernel, rows(mic.shape, 3), rows(kernel.applied[0].participation, 3)) +
                  rows(mic.load_residual, 3),
              displaced.middleRows(3 * places[0], 3));
}

/// A rod of length 2 along x with ρA = 1 and EA = 1.5.
Made rod(const std::map<std::string, std::string>& support) {
  scene::KernelRequest request = request_of({"right"}, support);
  request.loads.motions = {load("shaker", "left")};
  request.loads.tractions = {load("pull", "right")};
  request.receivers = {receiver("mic", {0.6, 0, 0})};
  return Made(test::rod_geo(40), 3, request);
}

// The modes are √(2/(ρAL)) sin((n − ½)πx/L), and Ψ = 1.
TEST(Rod, whose_only_support_moves_has_its_participation_in_closed_form) {
  Made made = rod({{"left", "x"}});
  const kernels::Kernel kernel = made.kernel({.count = 6});
  const double length = 2, mass = 2;
  for (std::size_t n = 0; n < 6; ++n) {
    const double exact = std::sqrt(2 * mass) / ((static_cast<double>(n) + 0.5) * std::numbers::pi);
    EXPECT_NEAR(std::abs(kernel.motions[0].participation[n]), exact, 1e-6 * exact);
    EXPECT_EQ(kernel.motions[0].participation[6 + n], 0);
  }
  // A traction of 1 Pa on the cross-section of 0.5 m² gives u = 0.5 x / EA.
  EXPECT_NEAR(kernel.applied[0].total[0], 0.5, 1e-15);
  const MatrixXd part = rows(kernel.applied[0].participation, 3);
  EXPECT_NEAR(modal(kernel, shape_of(kernel), part)(0, 0) + kernel.applied[0].residual[0], 0.5 * length / 1.5,
              1e-9);
  EXPECT_NEAR(
      modal(kernel, rows(kernel.receivers[0].shape, 3), part)(0, 0) + kernel.receivers[0].load_residual[0],
      0.5 * 0.6 / 1.5, 1e-9);
}

// The modes are √(2/(ρAL)) sin(nπx/L), and Ψ = 1 − x/L.
TEST(Rod, fixed_at_one_end_and_moved_at_the_other_has_its_participation_in_closed_form) {
  Made made = rod({{"left", "x"}, {"right", "xyz"}});
  const kernels::Kernel kernel = made.kernel({.count = 6});
  const double mass = 2;
  double momentum = mass / 2, rest = 1 - 0.3;
  for (std::size_t n = 0; n < 6; ++n) {
    const double turns = static_cast<double>(n + 1) * std::numbers::pi, exact = std::sqrt(2 * mass) / turns;
    EXPECT_NEAR(std::abs(kernel.motions[0].participation[n]), exact, 1e-6 * exact);
    momentum -= exact * std::sqrt(2 * mass) * (1 - std::cos(turns)) / turns;
    rest -= exact * std::sqrt(2 / mass) * std::sin(0.3 * turns);
  }
  EXPECT_NEAR(kernel.motions[0].momentum[0], momentum, 1e-5);
  EXPECT_NEAR(kernel.receivers[0].motion_residual[0], rest, 1e-5);
  EXPECT_NEAR(kernel.motions[0].residual[0], 0, 1e-12);  // the fixed end does not move
}

// A node that belongs to both supports moves with one of them, not with both.
TEST(Lift, of_all_supports_together_is_a_rigid_translation) {
  scene::KernelRequest request = request_of({"top"}, {{"bottom", "xyz"}, {"sides", "xyz"}});
  request.loads.motions = {load("bottom", "bottom"), load("sides", "sides")};
  request.receivers = {receiver("inside", {0.4, 0.3, 0.7}), receiver("edge", {0.5, 0, 0})};
  Made made(test::block_geo("tet", 2, 0.3), 2, request);
  const kernels::Kernel kernel = made.kernel({.count = 5});
  const MatrixXd gamma = rows(kernel.motions[0].participation, 3) + rows(kernel.motions[1].participation, 3);
  EXPECT_LT((gamma - rows(kernel.loads.body_force, 3)).norm(), 1e-9);
  for (const kernels::Receiver& place : kernel.receivers) {
    const MatrixXd left = rows(place.motion_residual, 3);
    EXPECT_LT((rows(place.shape, 3) * gamma.transpose() + left.leftCols(3) + left.rightCols(3) -
               Matrix3d::Identity())
                  .norm(),
              1e-9);
  }
}

// A cube on a hinge along x, at y = z = 0. Its lifts are e_y + θ e_x × x. The condition
// ∫ (e_x × x)·Ψ = 0 gives θ = ¾, because ∫ z = ½ and ∫ (y² + z²) = ⅔; for e_z it gives −¾.
// The hinge therefore does not rotate the cube.
TEST(Lift, of_a_hinge_does_not_excite_the_rotation_that_it_leaves_free) {
  scene::KernelRequest request = request_of({"top"}, {{"hinge", "xyz"}});
  request.loads.motions = {load("hinge", "hinge")};
  request.receivers = {receiver("mic", {0.3, 0.4, 0.8})};
  // Linear elements are used because M of quadratic ones does not couple the nodes
  // of the hinge to the rotation about it.
  Made made(test::block_geo("hex", 2, 0) + "Physical Curve(\"hinge\") = {1};\n", 1, request);
  const kernels::Kernel kernel = made.kernel({.count = 8});
  const MatrixXd gamma = rows(kernel.motions[0].participation, 3);
  ASSERT_EQ(kernel.modes.angular_frequency[0], 0);
  ASSERT_GT(kernel.modes.angular_frequency[1], 0);
  EXPECT_LT(gamma.col(0).norm(), 1e-10);
  Matrix3d exact;
  exact << 1, 0, 0, 0, 1 - 0.75 * 0.8, 0.75 * 0.8, 0, 0.75 * 0.4, 1 - 0.75 * 0.4;
  EXPECT_LT((rows(kernel.receivers[0].shape, 3) * gamma.transpose() +
             rows(kernel.receivers[0].motion_residual, 3) - exact)
                .norm(),
            1e-9);
}

}  // namespace lift_test
}  // namespace ricochet
