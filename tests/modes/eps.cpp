// SPDX-License-Identifier: BSD-2-Clause
// The solver as a type of SLEPc's EPS: eigenvalues of a membrane of bilinear elements, which are known in
// closed form and mostly double, and other types of EPS in its place.
#include "ricochet/eps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "src/modes/modes.hpp"
#include "tests/meshes.hpp"
#include "tests/modes/dense.hpp"

namespace ricochet {
namespace eps_test {

using parallel::check;

/// A square membrane of side 1 with n × n unknowns, fixed or free at its edge.
class Membrane {
 public:
  Membrane(PetscInt n, bool fixed) : n_(n), fixed_(fixed) {
    stiffness = assembled([this](PetscInt i, PetscInt j, PetscInt k, PetscInt l) {
      return bar_stiffness(i, k) * bar_mass(j, l) + bar_mass(i, k) * bar_stiffness(j, l);
    });
    mass = assembled(
        [this](PetscInt i, PetscInt j, PetscInt k, PetscInt l) { return bar_mass(i, k) * bar_mass(j, l); });
  }

  /// All eigenvalues: sums of two of a bar, 6/h² (1 − cos θ)/(2 + cos θ).
  std::vector<double> eigenvalues() const {
    std::vector<double> of_bar, sums;
    for (PetscInt i = 0; i < n_; ++i) {
      const double angle = std::numbers::pi * (fixed_ ? (i + 1.0) / (n_ + 1) : i / (n_ - 1.0));
      of_bar.push_back(6 / (h() * h()) * (1 - std::cos(angle)) / (2 + std::cos(angle)));
    }
    for (const double a : of_bar)
      for (const double b : of_bar) sums.push_back(a + b);
    std::ranges::sort(sums);
    return sums;
  }

  parallel::Matrix stiffness, mass;

 private:
  double h() const { return 1.0 / (fixed_ ? n_ + 1 : n_ - 1); }
  bool at_free_end(PetscInt i) const { return !fixed_ && (i == 0 || i == n_ - 1); }
  double bar_stiffness(PetscInt i, PetscInt k) const {
    return (i == k ? (at_free_end(i) ? 1 : 2) : -1) / h();
  }
  double bar_mass(PetscInt i, PetscInt k) const { return (i == k ? (at_free_end(i) ? 2 : 4) : 1) * h() / 6; }

  template <class Entry>
  parallel::Matrix assembled(const Entry& entry) const {
    parallel::Matrix matrix;
    check(MatCreateAIJ(PETSC_COMM_WORLD, PETSC_DECIDE, PETSC_DECIDE, n_ * n_, n_ * n_, 9, nullptr, 9, nullptr,
                       matrix.out()));
    PetscInt first = 0, end = 0;
    check(MatGetOwnershipRange(matrix, &first, &end));
    for (PetscInt row = first; row < end; ++row)
      for (PetscInt k = std::max<PetscInt>(row / n_ - 1, 0); k <= std::min(row / n_ + 1, n_ - 1); ++k)
        for (PetscInt l = std::max<PetscInt>(row % n_ - 1, 0); l <= std::min(row % n_ + 1, n_ - 1); ++l)
          check(MatSetValue(matrix, row, k * n_ + l, entry(row / n_, row % n_, k, l), INSERT_VALUES));
    check(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
    return matrix;
  }

  PetscInt n_;
  bool fixed_;
};

/// A free elastic block, whose matrices have blocks of three.
struct FreeBlock {
  test::SharedFile file{".geo", test::block_geo("tet", 2, 0.4)};
  mesh::GmshSession gmsh;
  scene::Body given = test::body_of(file.path(), 2);
  mesh::Mesh mesh = test::mesh_of(given);
  elasticity::Body body = elasticity::assemble(mesh, given.materials, "test");
};

using Solver = parallel::Handle<EPS, EPSDestroy>;

Solver solver_of(Mat stiffness, Mat mass) {
  Solver eps;
  check(EPSRicochetRegister());
  check(EPSCreate(PETSC_COMM_WORLD, eps.out()));
  check(EPSSetOperators(eps, stiffness, mass));
  check(EPSSetProblemType(eps, mass == nullptr ? EPS_HEP : EPS_GHEP));
  check(EPSSetType(eps, EPSRICOCHET));
  return eps;
}

std::vector<double> values_of(EPS eps) {
  PetscInt n = 0;
  check(EPSGetConverged(eps, &n));
  std::vector<double> values(static_cast<std::size_t>(n));
  for (PetscInt i = 0; i < n; ++i)
    check(EPSGetEigenvalue(eps, i, &values[static_cast<std::size_t>(i)], nullptr));
  return values;
}

/// Compares with the closed form to round-off of the assembled entries, relative to the largest eigenvalue
/// here.
void expect_values(EPS eps, const std::vector<double>& expected) {
  const std::vector<double> found = values_of(eps);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found[i], expected[i], 1e-10 * expected.back()) << i;
}

/// Checks K x = λ M x for every pair by PETSc's products, and that vectors are M-orthonormal.
void expect_pairs(EPS eps, Mat stiffness, Mat mass) {
  parallel::Vector x, y, force, momentum;
  check(MatCreateVecs(stiffness, x.out(), y.out()));
  check(VecDuplicate(x, force.out()));
  check(VecDuplicate(x, momentum.out()));
  PetscInt n = 0;
  check(EPSGetConverged(eps, &n));
  for (PetscInt i = 0; i < n; ++i) {
    double lambda = 0, norm = 0, error = 0, overlap = 0;
    check(EPSGetEigenpair(eps, i, &lambda, nullptr, x, nullptr));
    check(MatMult(stiffness, x, force));
    check(MatMult(mass, x, momentum));
    check(VecDot(x, momentum, &norm));
    EXPECT_NEAR(norm, 1, 1e-10);
    check(VecNorm(force, NORM_2, &norm));
    check(VecAXPY(force, -lambda, momentum));
    check(VecNorm(force, NORM_2, &error));
    EXPECT_LE(error, 1e-8 * norm) << i;
    for (PetscInt j = 0; j < i; ++j) {
      check(EPSGetEigenvector(eps, j, y, nullptr));
      check(VecDot(y, momentum, &overlap));
      EXPECT_NEAR(overlap, 0, 1e-6) << i << ", " << j;
    }
  }
}

constexpr PetscInt side = 24;

TEST(Eps, finds_the_lowest_with_multiple_ones_whole) {
  const Membrane membrane(side, true);
  const Solver eps = solver_of(membrane.stiffness, membrane.mass);
  std::vector<double> expected = membrane.eigenvalues();
  std::size_t first = 29;  // of a pair
  while (expected[first + 1] > (1 + 1e-12) * expected[first]) ++first;
  check(EPSSetDimensions(eps, static_cast<PetscInt>(first) + 1, PETSC_DEFAULT, PETSC_DEFAULT));
  check(EPSSolve(eps));
  ASSERT_GT(expected[first + 2], 1.01 * expected[first]);
  expected.resize(first + 2);
  expect_values(eps, expected);
  expect_pairs(eps, membrane.stiffness, membrane.mass);
}

TEST(Eps, finds_all_in_an_interval_and_proves_it) {
  const Membrane membrane(side, true);
  const std::vector<double> all = membrane.eigenvalues();
  const double low = (all[40] + all[42]) / 2, high = 1.001 * all[90];
  std::vector<double> expected;
  std::ranges::copy_if(all, std::back_inserter(expected), [&](double x) { return x > low && x < high; });
  const Solver eps = solver_of(membrane.stiffness, membrane.mass);
  check(EPSSetInterval(eps, low, high));
  check(EPSSetWhichEigenpairs(eps, EPS_ALL));
  check(EPSRicochetSetPerShift(eps, 20));
  check(EPSRicochetSetPartitions(eps, parallel::size_of(PETSC_COMM_WORLD)));
  check(EPSSolve(eps));
  expect_values(eps, expected);
  expect_pairs(eps, membrane.stiffness, membrane.mass);

  EPSRicochetCertificate certificate{};
  check(EPSRicochetGetCertificate(eps, &certificate));
  ASSERT_GE(certificate.shifts, 2);
  EXPECT_DOUBLE_EQ(certificate.origin, low);
  EXPECT_LE(certificate.residual, 1e-8);
  EXPECT_LE(certificate.orthonormality, 1e-6);
  for (PetscInt s = 0; s < certificate.shifts; ++s)
    EXPECT_EQ(certificate.eigenvalues[s],
              std::ranges::count_if(expected, [&](double x) { return x < certificate.shift[s]; }));
}

TEST(Eps, finds_the_zero_of_a_free_body_unless_it_is_deflated) {
  const Membrane membrane(side, false);
  std::vector<double> expected = membrane.eigenvalues();
  expected.resize(10);
  ASSERT_NEAR(expected[0], 0, 1e-12);
  const Solver with = solver_of(membrane.stiffness, membrane.mass);
  check(EPSSetDimensions(with, 10, PETSC_DEFAULT, PETSC_DEFAULT));
  check(EPSSolve(with));
  std::vector<double> found = values_of(with);
  found.resize(10);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_NEAR(found[i], expected[i], 1e-9 * expected[9]) << i;

  const Solver without = solver_of(membrane.stiffness, membrane.mass);
  parallel::Vector constant;
  check(MatCreateVecs(membrane.stiffness, constant.out(), nullptr));
  check(VecSet(constant, 3));
  Vec vectors[] = {constant};
  check(EPSSetDeflationSpace(without, 1, vectors));
  check(EPSSetDimensions(without, 9, PETSC_DEFAULT, PETSC_DEFAULT));
  check(EPSRicochetSetPartitions(without, parallel::size_of(PETSC_COMM_WORLD)));
  check(EPSSolve(without));
  found = values_of(without);
  ASSERT_GE(found.size(), 9u);
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(found[i], expected[i + 1], 1e-9 * expected[9]) << i;
}

TEST(Eps, finds_all_above_deflated_zeros_from_zero_on) {
  const Membrane membrane(side, false);
  std::vector<double> expected = membrane.eigenvalues();
  const double end = 1.01 * expected[40];
  std::erase_if(expected, [&](double x) { return x < 1e-9 || x > end; });
  const Solver eps = solver_of(membrane.stiffness, membrane.mass);
  parallel::Vector constant;
  check(MatCreateVecs(membrane.stiffness, constant.out(), nullptr));
  check(VecSet(constant, 3));
  Vec vectors[] = {constant};
  check(EPSSetDeflationSpace(eps, 1, vectors));
  check(EPSSetInterval(eps, 0, end));
  check(EPSSetWhichEigenpairs(eps, EPS_ALL));
  check(EPSSolve(eps));
  expect_values(eps, expected);
}

TEST(Eps, finds_negative_eigenvalues_too) {
  const Membrane membrane(side, true);
  constexpr double shift = 200;
  check(MatAXPY(membrane.stiffness, -shift, membrane.mass, SAME_NONZERO_PATTERN));
  std::vector<double> expected = membrane.eigenvalues();
  std::size_t count = 20;
  while (expected[count] < (1 + 1e-12) * expected[count - 1]) ++count;
  expected.resize(count);
  for (double& value : expected) value -= shift;
  ASSERT_LT(expected[3], 0);
  const Solver eps = solver_of(membrane.stiffness, membrane.mass);
  check(EPSSetDimensions(eps, static_cast<PetscInt>(count), PETSC_DEFAULT, PETSC_DEFAULT));
  check(EPSSolve(eps));
  expect_values(eps, expected);
}

TEST(Eps, finds_nothing_in_an_empty_interval) {
  const Membrane membrane(side, true);
  const std::vector<double> all = membrane.eigenvalues();
  const Solver eps = solver_of(membrane.stiffness, membrane.mass);
  check(EPSSetInterval(eps, 1.01 * all[0], 0.99 * all[1]));
  check(EPSSetWhichEigenpairs(eps, EPS_ALL));
  check(EPSSolve(eps));
  EXPECT_EQ(values_of(eps).size(), 0u);
}

TEST(Eps, finds_all_of_blocks_of_three) {
  // A free body, with six eigenvalues at zero.
  const FreeBlock block;
  const Eigen::VectorXd expected = test::dense_eigenvalues(block.mesh, block.body);
  const Solver eps = solver_of(block.body.stiffness, block.body.mass);
  check(EPSSetDimensions(eps, 20, PETSC_DEFAULT, PETSC_DEFAULT));
  check(EPSRicochetSetPartitions(eps, parallel::size_of(PETSC_COMM_WORLD)));
  check(EPSSolve(eps));
  const std::vector<double> found = values_of(eps);
  ASSERT_GE(found.size(), 20u);
  for (std::size_t i = 0; i < 20; ++i) EXPECT_NEAR(found[i], expected[i], 1e-8 * expected[19]) << i;
}

TEST(Eps, solves_a_problem_without_mass) {
  // Eigenvalues of K alone are not those of the membrane. Their sum of squares is its Frobenius norm.
  const Membrane membrane(8, true);
  const Solver eps = solver_of(membrane.stiffness, nullptr);
  check(EPSSetDimensions(eps, 64, PETSC_DEFAULT, PETSC_DEFAULT));
  check(EPSSolve(eps));
  double norm = 0, squares = 0;
  check(MatNorm(membrane.stiffness, NORM_FROBENIUS, &norm));
  const std::vector<double> found = values_of(eps);
  ASSERT_EQ(found.size(), 64u);
  for (const double value : found) squares += value * value;
  EXPECT_NEAR(std::sqrt(squares), norm, 1e-10 * norm);
}

TEST(Eps, refuses_what_it_cannot_prove) {
  const Membrane membrane(8, true);
  const Solver largest = solver_of(membrane.stiffness, membrane.mass);
  check(EPSSetWhichEigenpairs(largest, EPS_LARGEST_REAL));
  EXPECT_NE(EPSSolve(largest), 0);
  const Solver half_open = solver_of(membrane.stiffness, membrane.mass);
  check(EPSSetInterval(half_open, 0, PETSC_MAX_REAL));
  check(EPSSetWhichEigenpairs(half_open, EPS_ALL));
  EXPECT_NE(EPSSolve(half_open), 0);
  EPSRicochetCertificate certificate{};
  EXPECT_NE(EPSRicochetGetCertificate(half_open, &certificate), 0);
  EXPECT_NE(EPSRicochetSetPerShift(half_open, 0), 0);
  EXPECT_NE(EPSRicochetSetPartitions(half_open, 4), 0);  // of up to three ranks
}

TEST(Eps, of_other_types_gives_the_same_certified_modes) {
  const FreeBlock block;
  modes::Factorisation factor(block.body.stiffness, block.body.mass);
  const auto by = [&](const std::string& type) {
    return modes::compute_modes(test::one_team(), block.mesh, block.body, factor,
                                {.count = 25, .eps_type = type});
  };
  const modes::ModeSet ours = by("ricochet");
  for (const char* type : {"krylovschur", "arnoldi"}) {
    const modes::ModeSet theirs = by(type);
    EXPECT_TRUE(theirs.certificate.complete) << type;
    EXPECT_EQ(theirs.certificate.count_by_inertia, 25) << type;
    ASSERT_EQ(theirs.angular_frequency.size(), ours.angular_frequency.size()) << type;
    for (std::size_t n = 6; n < 25; ++n)
      EXPECT_NEAR(theirs.angular_frequency[n] / ours.angular_frequency[n], 1, 1e-10)
          << type << ", mode " << n;
  }
  EXPECT_THROW(by("nonesuch"), InputError);
}

}  // namespace eps_test
}  // namespace ricochet
