// SPDX-License-Identifier: BSD-2-Clause
// Patch tests: properties that every convergent element satisfies exactly.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "src/elasticity/assemble.hpp"
#include "src/elasticity/rigid.hpp"
#include "src/modes/factorisation.hpp"
#include "tests/meshes.hpp"
#include "tests/modes/dense.hpp"

namespace ricochet {
namespace patch_test {

struct Case {
  std::string kind;
  int order;
};

class Patch : public testing::TestWithParam<Case> {
 protected:
  static std::string geo() {
    const auto& [kind, order] = GetParam();
    const int divisions = order == 1 ? 4 : order == 4 && kind == "hex" ? 1 : 2;  // 1: for its time
    return kind == "prism" ? test::prism_geo(divisions) : test::block_geo(kind, divisions, lean());
  }
  static double lean() { return GetParam().kind == "prism" ? 0 : 0.4; }
  static bool inside(const double* x) {
    const double s = 0.5 * lean() * x[2], slack = 1e-9;
    return x[2] > slack && x[2] < 1 - slack && x[0] > s + slack && x[0] < 1 - s - slack && x[1] > s + slack &&
           x[1] < 1 - s - slack;
  }
};

// Rigid motions leave no force anywhere.
TEST_P(Patch, linear_displacement_leaves_no_force_inside_and_the_exact_energy) {
  const test::SharedFile file(".geo", geo());
  const mesh::GmshSession gmsh;
  const scene::Body given = test::body_of(file.path(), GetParam().order);
  const mesh::Mesh mesh = test::mesh_of(given);
  ASSERT_EQ(mesh.order, GetParam().order);
  const elasticity::Body body = elasticity::assemble(mesh, given.materials, "test");

  Eigen::Matrix3d gradient;
  gradient << 0.3, -0.2, 0.5, 0.1, 0.7, -0.4, 0.25, 0.6, -0.1;
  Eigen::MatrixXd u(body.local_rows, 1);
  for (std::size_t i = 0; i < mesh.node.size(); ++i) {
    const std::int64_t row = mesh.node[i] - mesh.first_node;
    if (row < 0 || row >= mesh.owned_nodes) continue;
    u.block<3, 1>(3 * row, 0) = gradient * Eigen::Map<const Eigen::Vector3d>(&mesh.position[3 * i]);
  }
  const Eigen::MatrixXd force = test::product(body.stiffness, u);
  double largest = force.size() > 0 ? force.cwiseAbs().maxCoeff() : 0, left = 0;
  std::int64_t interior = 0;
  for (std::size_t i = 0; i < mesh.node.size(); ++i) {
    const std::int64_t row = mesh.node[i] - mesh.first_node;
    if (row < 0 || row >= mesh.owned_nodes || !inside(&mesh.position[3 * i])) continue;
    left = std::max(left, force.block<3, 1>(3 * row, 0).cwiseAbs().maxCoeff());
    ++interior;
  }
  largest = parallel::largest(mesh.comm, largest);
  left = parallel::largest(mesh.comm, left);
  ASSERT_GT(parallel::sum(mesh.comm, interior), 0);
  // Some tens of elements contribute to a node, each with round-off.
  EXPECT_LT(left / largest, 1e-12);

  // Exact: W = ½ λ tr(ε)² V + μ ε:ε V, with the volume of a truncated pyramid.
  const auto& m = given.materials[0];
  const double lambda = m.young * m.poisson / ((1 + m.poisson) * (1 - 2 * m.poisson)),
               mu = m.young / (2 * (1 + m.poisson));
  const Eigen::Matrix3d strain = (gradient + gradient.transpose()) / 2;
  const double top = 1 - lean(), volume = (1 + top + top * top) / 3;
  const double exact = (0.5 * lambda * strain.trace() * strain.trace() + mu * strain.squaredNorm()) * volume;
  EXPECT_NEAR(0.5 * modes::inner(mesh.comm, u, force)(0, 0), exact, 1e-12 * exact);
  EXPECT_NEAR(body.total_mass, m.density * volume, 1e-12);

  const Eigen::MatrixXd rigid = elasticity::rigid_modes(mesh, body);
  ASSERT_EQ(rigid.cols(), 6);
  EXPECT_LT(parallel::largest(mesh.comm, test::largest_entry(test::product(body.stiffness, rigid))),
            1e-12 * 100);  // diagonal entries of K are of order 10
  const Eigen::MatrixXd gram = modes::inner(mesh.comm, rigid, test::product(body.mass, rigid));
  EXPECT_LT((gram - Eigen::MatrixXd::Identity(6, 6)).cwiseAbs().maxCoeff(), 1e-12);
}

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  for (const char* kind : {"tet", "hex", "prism"})
    for (int order = 1; order <= 4; ++order) cases.push_back({kind, order});
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Elements, Patch, testing::ValuesIn(all_cases()),
                         [](const auto& it) { return it.param.kind + std::to_string(it.param.order); });

/// The unit cube of tetrahedra whose nodes are moved by x_k += a_k x_{k+1}^p with the order p of the
/// elements, which curves elements exactly: their interpolation is the same map.
class CurvedTetrahedra : public testing::TestWithParam<int> {
 protected:
  CurvedTetrahedra() {
    const test::SharedFile file(".geo", test::block_geo("tet", 1, 0));
    given_ = test::body_of(file.path(), order_);
    mesh_ = test::mesh_of(given_);
    for (std::size_t i = 0; i < mesh_.node.size(); ++i) {
      const Eigen::Map<Eigen::Vector3d> x(&mesh_.position[3 * i]);
      interior_.push_back((x.array() > 1e-9).all() && (x.array() < 1 - 1e-9).all());
    }
    for (std::size_t i = 0; i < mesh_.node.size(); ++i) {
      Eigen::Map<Eigen::Vector3d> x(&mesh_.position[3 * i]);
      const Eigen::Vector3d straight = x;
      for (int k = 0; k < 3; ++k) x[k] += bend_[k] * std::pow(straight[(k + 1) % 3], order_);
    }
    body_ = elasticity::assemble(mesh_, given_.materials, "test");
  }
  const int order_ = GetParam();
  const Eigen::Vector3d bend_{0.2, -0.15, 0.25};
  const mesh::GmshSession gmsh_;
  scene::Body given_;
  mesh::Mesh mesh_;
  std::vector<bool> interior_;
  elasticity::Body body_;
};

INSTANTIATE_TEST_SUITE_P(Orders, CurvedTetrahedra, testing::Range(2, 5));

// det J = 1 + abc p³ (xyz)^{p−1}, so the volume is 1 + abc. For p = 2, ∫ x' det J has degree 5 on an element;
// for higher orders it exceeds the degree of the rule.
TEST_P(CurvedTetrahedra, have_the_exact_mass_and_with_order_2_the_exact_centre) {
  const double abc = bend_.prod(), volume = 1 + abc, p = order_;
  EXPECT_NEAR(body_.total_mass, given_.materials[0].density * volume, 1e-13);
  if (order_ != 2) return;
  for (int k = 0; k < 3; ++k) {
    const double a = bend_[k];
    const double moment = 0.5 + a / (p + 1) + abc * p / (p + 1) + a * abc / 2;
    EXPECT_NEAR(body_.centre[k], moment / volume, 1e-13) << k;
  }
}

TEST_P(CurvedTetrahedra, pass_the_patch_test_with_the_exact_energy) {
  Eigen::Matrix3d gradient;
  gradient << 0.3, -0.2, 0.5, 0.1, 0.7, -0.4, 0.25, 0.6, -0.1;
  Eigen::MatrixXd u(body_.local_rows, 1);
  for (std::size_t i = 0; i < mesh_.node.size(); ++i) {
    const std::int64_t row = mesh_.owned(mesh_.node[i]);
    if (row >= 0)
      u.block<3, 1>(3 * row, 0) = gradient * Eigen::Map<const Eigen::Vector3d>(&mesh_.position[3 * i]);
  }
  const Eigen::MatrixXd force = test::product(body_.stiffness, u);
  double left = 0;
  std::int64_t inside = 0;
  for (std::size_t i = 0; i < mesh_.node.size(); ++i) {
    const std::int64_t row = mesh_.owned(mesh_.node[i]);
    if (row < 0 || !interior_[i]) continue;
    left = std::max(left, force.block<3, 1>(3 * row, 0).cwiseAbs().maxCoeff());
    ++inside;
  }
  ASSERT_GT(parallel::sum(mesh_.comm, inside), 0);
  EXPECT_LT(parallel::largest(mesh_.comm, left), 1e-12);  // forces on the surface are of order 1
  const auto& m = given_.materials[0];
  const double lambda = m.young * m.poisson / ((1 + m.poisson) * (1 - 2 * m.poisson)),
               mu = m.young / (2 * (1 + m.poisson));
  const Eigen::Matrix3d strain = (gradient + gradient.transpose()) / 2;
  const double exact =
      (0.5 * lambda * strain.trace() * strain.trace() + mu * strain.squaredNorm()) * (1 + bend_.prod());
  EXPECT_NEAR(0.5 * modes::inner(mesh_.comm, u, force)(0, 0), exact, 1e-12 * exact);
}

TEST(RodPatch, linear_displacement_loads_the_ends_alone_in_every_order) {
  const test::SharedFile file(
      ".geo",
      "Point(1) = {0,0,0};\nPoint(2) = {2,0,0};\nLine(1) = {1,2};\nTransfinite Curve{1} = 6;\n"
      "Physical Curve(\"rod\") = {1};\n");
  const mesh::GmshSession gmsh;
  for (int order = 1; order <= 4; ++order) {
    const scene::Body given = test::body_of(file.path(), order);
    const mesh::Mesh mesh = test::mesh_of(given);
    ASSERT_EQ(mesh.order, order);
    const elasticity::Body body = elasticity::assemble(mesh, given.materials, "test");
    Eigen::MatrixXd u(body.local_rows, 2);
    Eigen::VectorXd exact(body.local_rows);
    for (std::size_t i = 0; i < mesh.node.size(); ++i) {
      const std::int64_t row = mesh.node[i] - mesh.first_node;
      if (row < 0 || row >= mesh.owned_nodes) continue;
      const double x = mesh.position[3 * i];
      u(row, 0) = 0.3 * x;
      u(row, 1) = 1;
      // EA u' at the ends: 3 · 0.5 · 0.3.
      exact[row] = x < 1e-9 ? -0.45 : x > 2 - 1e-9 ? 0.45 : 0;
    }
    const Eigen::MatrixXd force = test::product(body.stiffness, u);
    EXPECT_LT(parallel::largest(mesh.comm, test::largest_entry(force.col(0) - exact)), 1e-12) << order;
    EXPECT_LT(parallel::largest(mesh.comm, test::largest_entry(force.col(1))), 1e-12 * 100) << order;
    EXPECT_NEAR(body.total_mass, 2.0 * 0.5 * 2, 1e-12);
  }
}

}  // namespace patch_test
}  // namespace ricochet
