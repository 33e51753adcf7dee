// SPDX-License-Identifier: BSD-2-Clause
// The coupling of nearly equal modes compared with integrals over the elements of a lattice.
#include "src/reduction/coriolis.hpp"

#include <gtest/gtest.h>

#include <array>

#include "tests/meshes.hpp"

namespace ricochet {
namespace coriolis_test {

using Eigen::Index;
using Eigen::Vector3d;

/// ∫ρ φ_m × φ_n over the elements of a unit cube of 2³ equal hexahedra of order 1, whose shape functions are
/// products of linear ones: ∫ N_a N_b = h³/216 Π (1 + δ).
/// @param shape  (81,N) nodal values, nodes in the order of the lattice
Vector3d integral(const Eigen::MatrixXd& shape, Index m, Index n, double density) {
  const auto node = [](int cell, int corner) {
    const std::array<int, 3> at{cell % 2 + corner % 2, cell / 2 % 2 + corner / 2 % 2, cell / 4 + corner / 4};
    return 3 * (at[0] + 3 * at[1] + 9 * at[2]);
  };
  Vector3d sum = Vector3d::Zero();
  for (int cell = 0; cell < 8; ++cell)
    for (int a = 0; a < 8; ++a)
      for (int b = 0; b < 8; ++b) {
        const int same = (a % 2 == b % 2) + (a / 2 % 2 == b / 2 % 2) + (a / 4 == b / 4);
        const Vector3d of_m = shape.block<3, 1>(node(cell, a), m), of_n = shape.block<3, 1>(node(cell, b), n);
        sum += density * 0.125 / 216 * (1 << same) * of_m.cross(of_n);
      }
  return sum;
}

void compare(const parallel::Teams& teams) {
  const mesh::GmshSession gmsh;
  const test::SharedFile file(".geo", test::block_geo("hex", 2, 0));
  const scene::Body asked = test::body_of(file.path(), 1);
  const mesh::Mesh mesh = test::mesh_of(asked, teams);
  const elasticity::Body body = elasticity::assemble(mesh, asked.materials, "test");
  modes::Factorisation factor(body.stiffness, body.mass);
  const modes::ModeSet set = modes::compute_modes(teams, mesh, body, factor, {.count = 60});
  const kernels::Coriolis found = reduction::coriolis(teams, body.mass, set);

  Eigen::MatrixXd mine = Eigen::MatrixXd::Zero(81, set.shape.cols());
  mesh.for_each_owned([&](std::size_t i, std::int64_t row) {
    const auto at = [&](std::size_t k) { return std::lround(2 * mesh.position[3 * i + k]); };
    mine.middleRows(3 * (at(0) + 3 * at(1) + 9 * at(2)), 3) = set.shape.middleRows(3 * row, 3);
  });
  parallel::sum(teams.team(), mine);
  const Eigen::MatrixXd shape = set.gather(teams, mine);

  const std::vector<double>& omega = set.angular_frequency;
  std::size_t pair = 0;
  double largest = 0;
  for (Index m = 6; m < std::ssize(omega); ++m)
    for (Index n = m + 1; n < std::ssize(omega); ++n) {
      if (omega[n] - omega[m] >= 0.02 * omega[m]) continue;
      ASSERT_LT(2 * pair, found.pair.size());
      EXPECT_EQ(found.pair[2 * pair], m);
      EXPECT_EQ(found.pair[2 * pair + 1], n);
      const Vector3d expected = integral(shape, m, n, asked.materials[0].density);
      // Nodes of the mesh are in their places to about 1e-12.
      EXPECT_LT((Eigen::Map<const Vector3d>(&found.coupling[3 * pair]) - expected).norm(), 1e-11)
          << m << ", " << n;
      largest = std::max(largest, expected.norm());
      ++pair;
    }
  EXPECT_EQ(found.pair.size(), 2 * pair);
  EXPECT_EQ(found.coupling.size(), 3 * pair);
  EXPECT_GE(pair, 20);  // a cube has double and triple modes
  EXPECT_GT(largest, 0.5);
}

TEST(Coriolis, of_a_mesh_is_the_integral_over_its_elements) { compare(test::one_team()); }

TEST(Coriolis, is_passed_on_between_teams) { compare(test::own_teams()); }

TEST(Coriolis, of_distinct_modes_is_empty) {
  modes::ModeSet set;
  set.angular_frequency = {0, 0, 0, 1, 1.03, 1.06};
  EXPECT_EQ(reduction::coriolis(test::one_team(), nullptr, set), kernels::Coriolis{});
}

}  // namespace coriolis_test
}  // namespace ricochet
