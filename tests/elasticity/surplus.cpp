// SPDX-License-Identifier: BSD-2-Clause
// Estimated errors of eigenvalues compared with those of elements of orders 3 and 4, and with the exact ones
// of rods.
#include "src/elasticity/surplus.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "src/elasticity/assemble.hpp"
#include "src/modes/modes.hpp"
#include "tests/meshes.hpp"

namespace ricochet {
namespace surplus_test {

using Eigen::Index;
using Eigen::VectorXd;

struct Estimated {
  VectorXd lambda, error;  ///< of the elastic modes
};

/// @param count  of modes, with those of rigid motion
Estimated estimated(const scene::Body& asked, std::int64_t count) {
  const mesh::Mesh mesh = test::mesh_of(asked);
  const elasticity::Body body = elasticity::assemble(mesh, asked.materials, "test");
  modes::Factorisation factor(body.stiffness, body.mass);
  const modes::ModeSet modes = modes::compute_modes(test::one_team(), mesh, body, factor, {.count = count});
  std::vector<Index> elastic;
  for (std::size_t n = 0; n < modes.angular_frequency.size(); ++n)
    if (modes.angular_frequency[n] > 0) elastic.push_back(static_cast<Index>(n));
  VectorXd lambda(std::ssize(elastic));
  for (Index k = 0; k < lambda.size(); ++k)
    lambda[k] = std::pow(modes.angular_frequency[static_cast<std::size_t>(elastic[k])], 2);
  return {lambda,
          elasticity::eigenvalue_errors(mesh, asked.materials, modes.shape(Eigen::all, elastic), lambda)};
}

struct Case {
  std::string name, geo;
  int order, truth;
  std::map<std::string, std::string> support;
  double smallest, largest;  ///< of estimate / true error
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class Surplus : public testing::TestWithParam<Case> {};

TEST_P(Surplus, is_the_error_of_eigenvalues) {
  const mesh::GmshSession gmsh;
  const Case& c = GetParam();
  const test::SharedFile file(".geo", c.geo);
  scene::Body body = test::body_of(file.path(), c.order);
  body.support = c.support;
  const Estimated found = estimated(body, 18);
  body.order = c.truth;
  const VectorXd truth = estimated(body, 18).lambda;
  std::vector<double> ratios;
  for (Index k = 0; k < std::min(found.lambda.size(), truth.size()); ++k)
    ratios.push_back(found.error[k] / (found.lambda[k] - truth[k]));
  std::ranges::sort(ratios);
  const double median = ratios[ratios.size() / 2];
  EXPECT_GT(ratios.front(), c.smallest);
  EXPECT_GT(median, 0.8);
  EXPECT_LT(median, 1.5);
  EXPECT_LT(ratios.back(), c.largest);
}

// The prototype of this estimate had ratios of 0.65 to 2.05 for tetrahedra, and of 0.47 to 1.9 for hexahedra.
// Two hexahedra along each edge have errors of up to 17 %.
INSTANTIATE_TEST_SUITE_P(
    Bodies, Surplus,
    testing::Values(Case{"tetrahedra", test::block_geo("tet", 2, 0.3), 2, 4, {}, 0.5, 2.1},
                    Case{"tetrahedra_of_order_3", test::block_geo("tet", 2, 0.3), 3, 4, {}, 0.9, 1.7},
                    Case{"hexahedra", test::block_geo("hex", 2, 0.3), 2, 3, {}, 0.25, 3},
                    Case{"prisms", test::prism_geo(2), 2, 3, {}, 0.6, 2},
                    Case{"supported", test::block_geo("tet", 2, 0.3), 2, 4, {{"bottom", "xyz"}}, 0.7, 1.5}),
    [](const auto& one) { return one.param.name; });

// The new functions of different elements of a rod are orthogonal, so that their sum is the whole change to
// the next order. ω_k = k π c/L with L = 2 and c² = E/ρ = 3/2.
TEST(SurplusOfRods, is_the_error_of_eigenvalues) {
  const mesh::GmshSession gmsh;
  const test::SharedFile file(".geo", test::rod_geo(10));
  const Estimated found = estimated(test::body_of(file.path(), 2), 12);
  for (Index k = 0; k < found.lambda.size(); ++k) {
    const double omega = (k + 1.0) * std::numbers::pi / 2 * std::sqrt(1.5);
    const double ratio = found.error[k] / (found.lambda[k] - omega * omega);
    EXPECT_GT(ratio, k < 5 ? 0.93 : 0.65);
    EXPECT_LT(ratio, k < 5 ? 1.0 : 1.2);
  }
}

}  // namespace surplus_test
}  // namespace ricochet
