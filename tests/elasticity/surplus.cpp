// SPDX-License-Identifier: BSD-2-Clause
// Estimated errors of modes compared with those of elements of orders 3 and 4, and with the exact ones of
// rods.
#include "src/elasticity/surplus.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "src/elasticity/assemble.hpp"
#include "src/modes/modes.hpp"
#include "tests/meshes.hpp"

namespace ricochet {
namespace surplus_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Place = std::array<std::int64_t, 3>;  ///< [µm]

struct Estimated {
  VectorXd lambda;                         ///< of the elastic modes
  MatrixXd excess;                         ///< of their stiffness
  std::map<Place, Eigen::MatrixXd> shape;  ///< (3, modes) by place of a node, on every rank
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
  const MatrixXd shape = modes.shape(Eigen::all, elastic);
  Estimated out{lambda, elasticity::stiffness_errors(mesh, asked.materials, shape, lambda), {}};
  if (mesh.dim != 3) return out;
  MatrixXd place = MatrixXd::Zero(3, mesh.total_nodes),
           at = MatrixXd::Zero(3 * mesh.total_nodes, shape.cols());
  mesh.for_each_owned([&](std::size_t i, std::int64_t row) {
    for (std::size_t k = 0; k < 3; ++k) place(static_cast<Index>(k), mesh.node[i]) = mesh.position[3 * i + k];
    at.middleRows(3 * mesh.node[i], 3) = shape.middleRows(3 * row, 3);
  });
  for (MatrixXd* of_rank : {&place, &at}) parallel::sum(mesh.comm, *of_rank);
  for (Index node = 0; node < mesh.total_nodes; ++node) {
    const Eigen::Matrix<std::int64_t, 3, 1> in_micrometres =
        (1e6 * place.col(node)).array().round().cast<std::int64_t>();
    out.shape[{in_micrometres[0], in_micrometres[1], in_micrometres[2]}] = at.middleRows(3 * node, 3);
  }
  return out;
}

struct Case {
  std::string name, geo;
  int order, truth;
  std::map<std::string, std::string> support;
  double smallest, largest;  ///< of estimate / true error
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class SurplusOfSolids : public testing::TestWithParam<Case> {};

TEST_P(SurplusOfSolids, is_the_error_of_eigenvalues) {
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
    ratios.push_back(found.excess(k, k) / (found.lambda[k] - truth[k]));
  std::ranges::sort(ratios);
  const double median = ratios[ratios.size() / 2];
  EXPECT_GT(ratios.front(), c.smallest);
  EXPECT_GT(median, 0.8);
  EXPECT_LT(median, 1.5);
  EXPECT_LT(ratios.back(), c.largest);
}

/// Distances of the lowest modes of one mesh from those of another, at the nodes of both, up to the sign.
VectorXd distances(const Estimated& one, const Estimated& other, Index count) {
  VectorXd less = VectorXd::Zero(count), more = less;
  for (const auto& [place, shape] : one.shape) {
    const auto there = other.shape.find(place);
    if (there == other.shape.end()) continue;
    less +=
        (shape - there->second.leftCols(shape.cols())).leftCols(count).colwise().squaredNorm().transpose();
    more +=
        (shape + there->second.leftCols(shape.cols())).leftCols(count).colwise().squaredNorm().transpose();
  }
  return less.cwiseMin(more).cwiseSqrt();
}

// Exact elements combine the modes of a mesh to theirs as the excess of their stiffness tells, which changes
// modes by as much as elements of order 4 do. Without entries beside the diagonal, modes do not change.
TEST(Surplus, changes_modes_as_much_as_finer_elements) {
  const mesh::GmshSession gmsh;
  const test::SharedFile file(".geo",  // of three lengths, so that no modes are equal
                              "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 1, 0.6, 0.35};\n"
                              "MeshSize{:} = 0.3;\nPhysical Volume(\"body\") = {1};\n"
                              "Physical Surface(\"skin\") = Surface{:};\n");
  scene::Body body = test::body_of(file.path(), 4);
  const Estimated exact = estimated(body, 40);
  constexpr Index lowest = 8;
  for (const int order : {2, 3}) {
    body.order = order;
    const Estimated found = estimated(body, 40);
    const Eigen::SelfAdjointEigenSolver<MatrixXd> combined(MatrixXd(found.lambda.asDiagonal()) -
                                                           found.excess);
    Estimated moved = found;
    for (auto& [place, shape] : moved.shape) shape *= combined.eigenvectors();
    VectorXd ratio = distances(found, moved, lowest).cwiseQuotient(distances(found, exact, lowest));
    std::ranges::sort(ratio);
    EXPECT_GT(ratio[0], 0.3) << ratio.transpose();
    EXPECT_GT(ratio[lowest / 2], 0.7) << ratio.transpose();
    EXPECT_LT(ratio[lowest - 1], 1.8) << ratio.transpose();
  }
}

// The prototype of this estimate had ratios of 0.65 to 2.05 for tetrahedra, and of 0.47 to 1.9 for hexahedra.
// Two hexahedra along each edge have errors of up to 17 %.
INSTANTIATE_TEST_SUITE_P(
    Bodies, SurplusOfSolids,
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
    const double ratio = found.excess(k, k) / (found.lambda[k] - omega * omega);
    EXPECT_GT(ratio, k < 5 ? 0.93 : 0.65);
    EXPECT_LT(ratio, k < 5 ? 1.0 : 1.2);
  }
}

}  // namespace surplus_test
}  // namespace ricochet
