// SPDX-License-Identifier: BSD-2-Clause
// Contact-adapted bases compared with dense flexibilities of the complete body.
#include "src/reduction/contact_basis.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <memory>
#include <numbers>

#include "src/reduction/residual.hpp"
#include "src/surface/patches.hpp"
#include "src/surface/trace.hpp"
#include "tests/meshes.hpp"
#include "tests/modes/dense.hpp"

namespace ricochet {
namespace contact_basis_test {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A body whose top may touch, with the load vectors of its patches and of gravity.
struct Struck {
  mesh::Mesh mesh;
  elasticity::Body body;
  std::unique_ptr<modes::Factorisation> factor;
  MatrixXd loads;
  Eigen::Index seen = 0;

  Struck(bool supported, const parallel::Teams& given) : teams(given) {
    const test::SharedFile file(".geo", test::block_geo("tet", 2, 0.3));
    scene::Body asked = test::body_of(file.path(), 2);
    asked.contact = {"top"};
    if (supported) asked.support = {{"bottom", "xyz"}};
    mesh = test::mesh_of(asked, teams);
    body = elasticity::assemble(mesh, asked.materials, "test");
    factor = std::make_unique<modes::Factorisation>(body.stiffness, body.mass);
    const surface::Patches patches =
        surface::make_patches(mesh, asked.contact, {.direction = Vector3{0, 0, 1}});
    const MatrixXd contact = surface::patch_loads(mesh, patches);
    seen = contact.cols();
    loads.resize(contact.rows(), seen + 3);
    loads << contact, body.rigid_load.leftCols(3);
  }

  modes::ModeSet basis(const reduction::ContactRequest& request) {
    return reduction::contact_basis(teams, mesh, body, *factor, loads, seen, request);
  }

  /// Traces of the vectors on the patches. (seen, N)
  MatrixXd trace(const modes::ModeSet& set) const {
    return set.gather(teams, modes::inner(mesh.comm, loads.leftCols(seen), set.shape));
  }

  const parallel::Teams& teams;
};

/// Dense K, M and loads on the free rows, and the responses that follow from them.
struct Dense {
  MatrixXd stiffness, mass, loads;

  /// @param struck  Struck or StruckRod
  explicit Dense(const auto& struck) {
    const MatrixXd k = test::dense(struck.mesh, struck.body, struck.body.stiffness),
                   m = test::dense(struck.mesh, struck.body, struck.body.mass);
    MatrixXd whole = MatrixXd::Zero(k.rows(), struck.loads.cols());
    whole.middleRows(struck.mesh.first_node * struck.mesh.components(), struck.loads.rows()) = struck.loads;
    parallel::sum(struck.mesh.comm, whole);
    const auto rows = test::free_rows(m);
    stiffness = k(rows, rows);
    mass = m(rows, rows);
    loads = whole(rows, Eigen::all);
  }

  /// Response to all loads, at the first `seen` of them, by a direct solve. (seen, all)
  MatrixXcd flexibility(std::complex<double> s, Eigen::Index seen) const {
    const MatrixXcd matrix = stiffness.cast<std::complex<double>>() + s * s * mass;
    return loads.leftCols(seen).transpose() * matrix.partialPivLu().solve(loads.cast<std::complex<double>>());
  }
};

/// Flexibility from Ritz vectors and their residual flexibility.
MatrixXcd flexibility(const modes::ModeSet& set, const MatrixXd& trace, const MatrixXd& residual,
                      std::complex<double> s) {
  Eigen::VectorXcd weight(trace.cols());
  for (Eigen::Index n = 0; n < weight.size(); ++n)
    weight[n] = 1.0 / (std::pow(set.angular_frequency[static_cast<std::size_t>(n)], 2) + s * s);
  return trace * weight.asDiagonal() * trace.transpose() + residual;
}

class ContactBasis : public testing::TestWithParam<bool> {};

TEST_P(ContactBasis, meets_its_estimate_of_the_flexibility_over_the_band) {
  const mesh::GmshSession gmsh;
  Struck struck(GetParam(), test::one_team());
  const Dense dense(struck);
  // A band that contains some of the 500 modes; the first elastic mode is at 0.2 Hz.
  const Hertz band{1.0};
  std::vector<std::complex<double>> at;
  std::vector<MatrixXcd> exact;
  for (int k = 1; k <= 9; ++k) {
    at.push_back(std::polar(static_cast<RadPerSecond>(band).value * k / 9, std::numbers::pi / 4));
    exact.push_back(dense.flexibility(at.back(), struck.seen).leftCols(struck.seen));
  }
  std::size_t before = 0;
  for (const double asked : {1e-1, 1e-2, 1e-3, 1e-4}) {
    const modes::ModeSet set = struck.basis({.band = band, .flexibility_error = asked});
    EXPECT_LE(set.certificate.flexibility_error, asked);
    EXPECT_GE(set.angular_frequency.size(), before);
    before = set.angular_frequency.size();
    const MatrixXd trace = struck.trace(set);
    const MatrixXd residual = reduction::residual_response(struck.teams, struck.mesh, struck.body,
                                                           *struck.factor, set, struck.loads.sparseView())
                                  .topLeftCorner(struck.seen, struck.seen);
    const auto rigid = std::count(set.angular_frequency.begin(), set.angular_frequency.end(), 0.0);
    EXPECT_EQ(rigid, GetParam() ? 0 : 6);
    double worst = 0;
    for (std::size_t k = 0; k < at.size(); ++k) {
      // The scale of the estimate is the elastic motion alone.
      const MatrixXcd elastic =
          exact[k] - trace.leftCols(rigid) * trace.leftCols(rigid).transpose() / (at[k] * at[k]);
      worst = std::max(worst, (flexibility(set, trace, residual, at[k]) - exact[k]).norm() / elastic.norm());
    }
    EXPECT_LE(worst, asked);
    EXPECT_LE(worst, 1.5 * set.certificate.flexibility_error);
    EXPECT_GT(worst, 1e-12);
  }
}

TEST_P(ContactBasis, with_its_residual_is_statically_exact) {
  const mesh::GmshSession gmsh;
  Struck struck(GetParam(), test::own_teams());
  const Dense dense(struck);
  // Few vectors leave a large residual.
  const modes::ModeSet set = struck.basis({.band = Hertz{1.0}, .flexibility_error = 0.3});
  const MatrixXd trace = struck.trace(set);
  const MatrixXd residual = reduction::residual_response(struck.teams, struck.mesh, struck.body,
                                                         *struck.factor, set, struck.loads.sparseView())
                                .topRows(struck.seen);
  // Static response of all elastic modes of the dense problem.
  const test::DenseModes all(struck.mesh.comm, dense.stiffness, dense.mass);
  const Eigen::Index rigid = GetParam() ? 0 : 6, elastic = all.value.size() - rigid;
  const MatrixXd seen = dense.loads.transpose() * all.vector.rightCols(elastic);
  const VectorXd compliance = all.value.tail(elastic).cwiseInverse();
  const MatrixXd exact = seen.topRows(struck.seen) * compliance.asDiagonal() * seen.transpose();
  const auto n = static_cast<Eigen::Index>(set.angular_frequency.size()) - rigid;
  const VectorXd ritz = Eigen::Map<const VectorXd>(set.angular_frequency.data() + rigid, n);
  const MatrixXd loads = set.gather(struck.teams, modes::inner(struck.mesh.comm, struck.loads, set.shape));
  const MatrixXd found =
      trace.rightCols(n) * ritz.cwiseAbs2().cwiseInverse().asDiagonal() * loads.rightCols(n).transpose() +
      residual;
  EXPECT_LT((found - exact).norm(), 1e-9 * exact.norm());
}

TEST_P(ContactBasis, ritz_values_are_no_lower_than_the_modes) {
  const mesh::GmshSession gmsh;
  Struck struck(GetParam(), test::own_teams());
  const VectorXd exact = test::dense_eigenvalues(struck.mesh, struck.body);
  const modes::ModeSet set = struck.basis({.band = Hertz{1.0}, .flexibility_error = 1e-2});
  for (std::size_t n = 0; n < set.angular_frequency.size(); ++n)
    EXPECT_GE(std::pow(set.angular_frequency[n], 2),
              exact[static_cast<Eigen::Index>(n)] - 1e-9 * exact[static_cast<Eigen::Index>(n)] -
                  (exact[static_cast<Eigen::Index>(n)] < 1e-6 ? 1e-6 : 0));
  EXPECT_LT(set.certificate.orthonormality, 1e-10);
  EXPECT_TRUE(set.certificate.complete);
}

TEST(ContactBasis, of_a_given_size_has_it) {
  const mesh::GmshSession gmsh;
  Struck struck(false, test::one_team());
  for (const std::int64_t count : {20, 101}) {
    const modes::ModeSet set = struck.basis({.band = Hertz{1.0}, .flexibility_error = 0, .count = count});
    EXPECT_EQ(set.angular_frequency.size(), static_cast<std::size_t>(count));
  }
}

/// A rod that is struck at its right end, or at other ends.
struct StruckRod {
  mesh::Mesh mesh;
  elasticity::Body body;
  std::unique_ptr<modes::Factorisation> factor;
  MatrixXd loads;

  explicit StruckRod(int elements, const std::vector<std::string>& ends = {"right"}) {
    const test::SharedFile file(".geo", test::rod_geo(elements));
    scene::Body asked = test::body_of(file.path(), 1);
    asked.contact = ends;
    mesh = test::mesh_of(asked);
    body = elasticity::assemble(mesh, asked.materials, "test");
    factor = std::make_unique<modes::Factorisation>(body.stiffness, body.mass);
    loads = surface::patch_loads(mesh, surface::make_patches(mesh, asked.contact, {}));
  }

  modes::ModeSet basis(const reduction::ContactRequest& request) {
    return reduction::contact_basis(test::one_team(), mesh, body, *factor, loads, loads.cols(), request);
  }
};

TEST(ContactBasis, with_all_vectors_is_the_body_itself) {
  const mesh::GmshSession gmsh;
  StruckRod rod(5);
  // With six nodes and one load, the Krylov space is the complete space.
  const modes::ModeSet set = rod.basis({.band = Hertz{10.0}, .flexibility_error = 1e-6});
  const VectorXd exact = test::dense_eigenvalues(rod.mesh, rod.body);
  ASSERT_EQ(set.angular_frequency.size(), 6u);
  for (std::size_t n = 1; n < 6; ++n)
    EXPECT_NEAR(set.angular_frequency[n], std::sqrt(exact[static_cast<Eigen::Index>(n)]),
                1e-8 * set.angular_frequency[n]);
}

TEST(ContactBasis, stays_free_of_rigid_motion_over_many_blocks) {
  const mesh::GmshSession gmsh;
  StruckRod rod(100);
  const modes::ModeSet set = rod.basis({.band = Hertz{2.0}, .count = 60});
  EXPECT_EQ(set.angular_frequency.size(), 60u);
  EXPECT_LT(set.certificate.orthonormality, 1e-12);
}

TEST(ContactBasis, is_only_rigid_if_nothing_more_is_requested) {
  const mesh::GmshSession gmsh;
  StruckRod rod(20);
  EXPECT_EQ(rod.basis({.band = Hertz{1.0}, .count = 1}).angular_frequency, std::vector<double>{0.0});
  // The first elastic mode is at 0.3 Hz, so the rod is rigid in a band far below it.
  EXPECT_EQ(rod.basis({.band = Hertz{1e-4}, .flexibility_error = 1e-3}).angular_frequency,
            std::vector<double>{0.0});
}

TEST(ContactBasis, works_with_candidates_that_a_support_holds) {
  const mesh::GmshSession gmsh;
  Struck struck(true, test::one_team());
  MatrixXd with_fixed(struck.loads.rows(), struck.seen + 1);
  with_fixed << MatrixXd::Zero(struck.loads.rows(), 1), struck.loads.leftCols(struck.seen);
  const reduction::ContactRequest request{.band = Hertz{1.0}, .flexibility_error = 1e-2};
  const modes::ModeSet set = reduction::contact_basis(struck.teams, struck.mesh, struck.body, *struck.factor,
                                                      with_fixed, with_fixed.cols(), request);
  EXPECT_LE(set.certificate.flexibility_error, 1e-2);
  const MatrixXd none = MatrixXd::Zero(struck.loads.rows(), 1);
  EXPECT_TRUE(
      reduction::contact_basis(struck.teams, struck.mesh, struck.body, *struck.factor, none, 1, request)
          .angular_frequency.empty());
}

// A rod under opposite forces on its ends, which stretch it, and much smaller equal ones. No mode responds to
// both, so the basis never contains the response to the latter once it has been omitted from the first block.
TEST(ContactBasis, counts_the_responses_that_it_omits_in_its_error) {
  const mesh::GmshSession gmsh;
  StruckRod rod(5, {"left", "right"});
  ASSERT_EQ(rod.loads.cols(), 6);  // three components at each end, of which a rod has the first
  const Hertz band{0.1};           // the first elastic mode is at 0.3 Hz
  const double omega = static_cast<RadPerSecond>(band).value, asked = 0.1, omitted = 0.04;
  const MatrixXd ends = rod.loads(Eigen::all, {0, 3});
  rod.loads.resize(Eigen::NoChange, 2);
  rod.loads << ends.col(1) - ends.col(0), ends.col(1) + ends.col(0);
  // Far below the modes, the response to a load l errs by ω² yᵀ M y with y = K⁻¹ l without its inertia. The
  // smaller load is scaled so that this is 0.04 of the error that is allowed relative to the flexibility.
  const Dense unscaled(rod);
  const test::DenseModes all(rod.mesh.comm, unscaled.stiffness, unscaled.mass);
  const MatrixXd seen = all.vector.rightCols(5).transpose() * unscaled.loads;
  const Eigen::ArrayXd lambda = all.value.tail(5);
  const double flexibility_of_stretch = (seen.col(0).array().square() / lambda).sum();
  const double response = (seen.col(1).array() / lambda).square().sum();
  rod.loads.col(1) *= std::sqrt(omitted * asked * flexibility_of_stretch / (omega * omega * response));

  const modes::ModeSet set = rod.basis({.band = band, .flexibility_error = asked});
  const MatrixXd trace = set.gather(test::one_team(), modes::inner(rod.mesh.comm, rod.loads, set.shape));
  const MatrixXd residual = reduction::residual_response(test::one_team(), rod.mesh, rod.body, *rod.factor,
                                                         set, rod.loads.sparseView());
  const std::complex<double> s = std::polar(omega, std::numbers::pi / 4);
  const MatrixXcd exact = Dense(rod).flexibility(s, 2);
  const MatrixXcd elastic = exact - trace.leftCols(1) * trace.leftCols(1).transpose() / (s * s);
  const double error = (flexibility(set, trace, residual, s) - exact).norm() / elastic.norm();
  EXPECT_GT(error, 0.9 * omitted * asked);
  EXPECT_LE(error, set.certificate.flexibility_error);
  EXPECT_LE(set.certificate.flexibility_error, asked);
}

TEST_P(ContactBasis, without_residual_flexibility_meets_its_estimate_too) {
  const mesh::GmshSession gmsh;
  Struck struck(GetParam(), test::one_team());
  const Dense dense(struck);
  const Hertz band{1.0};
  const modes::ModeSet set =
      struck.basis({.band = band, .flexibility_error = 1e-2, .residual_flexibility = false});
  const MatrixXd trace = struck.trace(set), nothing = MatrixXd::Zero(struck.seen, struck.seen);
  const std::complex<double> s = std::polar(static_cast<RadPerSecond>(band).value, std::numbers::pi / 4);
  const MatrixXcd exact = dense.flexibility(s, struck.seen).leftCols(struck.seen);
  const Eigen::Index rigid = GetParam() ? 0 : 6;
  const MatrixXcd elastic = exact - trace.leftCols(rigid) * trace.leftCols(rigid).transpose() / (s * s);
  EXPECT_LE((flexibility(set, trace, nothing, s) - exact).norm(), 1e-2 * elastic.norm());
}

INSTANTIATE_TEST_SUITE_P(Bodies, ContactBasis, testing::Bool(),
                         [](const auto& body) { return body.param ? "supported" : "free"; });

}  // namespace contact_basis_test
}  // namespace ricochet
