// SPDX-License-Identifier: BSD-2-Clause
// The next lower element order on the same elements.
#include "src/mesh/order_reduction.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "src/elasticity/assemble.hpp"
#include "tests/meshes.hpp"
#include "tests/modes/dense.hpp"

namespace ricochet {
namespace order_reduction_test {

struct Case {
  const char* name;
  std::string geo;
  int order;
};

/// Displacements that are polynomials of total degree `degree` in the position.
Eigen::MatrixXd polynomial(const mesh::Mesh& mesh, int degree) {
  const int c = mesh.components();
  Eigen::MatrixXd values(mesh.owned_nodes * c, 1);
  for (std::size_t i = 0; i < mesh.node.size(); ++i) {
    const std::int64_t row = mesh.node[i] - mesh.first_node;
    if (row < 0 || row >= mesh.owned_nodes) continue;
    const double* x = &mesh.position[3 * i];
    for (int k = 0; k < c; ++k)
      values(row * c + k, 0) = std::pow(1 + x[0] + (k + 1) * x[1] - 0.5 * x[2], degree);
  }
  return values;
}

class OrderReduction : public testing::TestWithParam<Case> {};

TEST_P(OrderReduction, order_contains_the_polynomials_of_its_degree) {
  const mesh::GmshSession gmsh;
  const test::SharedFile file(".geo", GetParam().geo);
  const mesh::Mesh mesh = test::mesh_of(test::body_of(file.path(), GetParam().order));
  const mesh::OrderReduction lower(mesh);
  const int degree = GetParam().order - 1;
  ASSERT_EQ(lower.mesh().order, degree);
  const Eigen::MatrixXd error = lower.prolong(polynomial(lower.mesh(), degree)) - polynomial(mesh, degree);
  // Round-off of the values, which reach 4.5^degree, and of the positions computed by gmsh.
  EXPECT_LT(parallel::largest(mesh.comm, test::largest_entry(error)), 1e-13 * std::pow(4.5, degree) * 10);
}

// For nested spaces, the matrices of the smaller space are projections of those of the larger. The test also
// covers numbering, ghosts and supports.
TEST_P(OrderReduction, order_has_the_projected_matrices_of_the_higher_one) {
  const mesh::GmshSession gmsh;
  const test::SharedFile file(".geo", GetParam().geo);
  scene::Body given = test::body_of(file.path(), GetParam().order);
  if (GetParam().name != std::string("rod")) given.support = {{"bottom", "xz"}};
  const mesh::Mesh mesh = test::mesh_of(given);
  const mesh::OrderReduction lower(mesh);
  const elasticity::Body body = elasticity::assemble(mesh, given.materials, "test"),
                         below = elasticity::assemble(lower.mesh(), given.materials, "test");
  EXPECT_NEAR(below.total_mass, body.total_mass, 1e-12 * body.total_mass);
  Eigen::MatrixXd x(below.local_rows, 2);
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    const auto row = static_cast<double>(lower.mesh().first_node * mesh.components() + i);
    x.row(i) << std::sin(row), std::cos(3 * row);
  }
  // Displacements held by a support do not belong to the space.
  for (std::size_t i = 0; i < lower.mesh().node.size(); ++i) {
    const std::int64_t row = lower.mesh().node[i] - lower.mesh().first_node;
    if (row < 0 || row >= lower.mesh().owned_nodes) continue;
    for (int k = 0; k < mesh.components(); ++k)
      if (lower.mesh().is_fixed(i, k)) x.row(row * mesh.components() + k).setZero();
  }
  const Eigen::MatrixXd raised = lower.prolong(x);
  for (const bool mass : {false, true}) {
    const Eigen::MatrixXd expected = modes::inner(mesh.comm, raised,
                                                  test::product(mass ? body.mass : body.stiffness, raised)),
                          found = modes::inner(mesh.comm, x,
                                               test::product(mass ? below.mass : below.stiffness, x));
    EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-11 * expected.cwiseAbs().maxCoeff()) << mass;
  }
}

INSTANTIATE_TEST_SUITE_P(Elements, OrderReduction,
                         testing::Values(Case{"tet_2", test::block_geo("tet", 2, 0), 2},
                                         Case{"tet_3", test::block_geo("tet", 2, 0), 3},
                                         Case{"tet_5", test::block_geo("tet", 1, 0), 5},
                                         Case{"hex_2", test::block_geo("hex", 2, 0), 2},
                                         Case{"hex_4", test::block_geo("hex", 2, 0), 4},
                                         Case{"prism_3", test::prism_geo(2), 3},
                                         Case{"rod", test::rod_geo(7), 3}),
                         [](const auto& instance) { return std::string(instance.param.name); });

}  // namespace order_reduction_test
}  // namespace ricochet
