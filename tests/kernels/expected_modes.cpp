// SPDX-License-Identifier: BSD-2-Clause
// The estimated number of modes: of plates against the waves between two free surfaces, which polynomials
// across the thickness resolve, and of rods against roots of their characteristic equations.
#include "kernels/expected_modes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <numeric>

namespace ricochet::kernels {
namespace expected_modes_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
constexpr double pi = std::numbers::pi;

/// Monomials on [-½, ½] would lose all digits, Legendre polynomials do not: their values and derivatives at
/// Gauss points, and weights, for a plate with ρ = μ = h = 1.
struct Across {
  static constexpr Index n = 16;
  MatrixXd value{n, n}, slope{n, n};  // at the points, by polynomial
  VectorXd weight{n};

  Across() {
    MatrixXd jacobi = MatrixXd::Zero(n, n);  // Golub & Welsch 1969
    for (Index k = 1; k < n; ++k)
      jacobi(k, k - 1) = jacobi(k - 1, k) =
          static_cast<double>(k) / std::sqrt(4.0 * static_cast<double>(k * k) - 1);
    const Eigen::SelfAdjointEigenSolver<MatrixXd> nodes(jacobi);
    for (Index i = 0; i < n; ++i) {
      const double x = nodes.eigenvalues()[i];
      weight[i] = std::pow(nodes.eigenvectors()(0, i), 2);
      value(i, 0) = 1;
      value(i, 1) = x;
      slope(i, 0) = 0;
      slope(i, 1) = 2;
      for (Index k = 2; k < n; ++k) {
        const auto m = static_cast<double>(k);
        value(i, k) = ((2 * m - 1) * x * value(i, k - 1) - (m - 1) * value(i, k - 2)) / m;
        slope(i, k) = slope(i, k - 2) + 2 * (2 * m - 1) * value(i, k - 1);
      }
    }
  }

  /// ω of all waves of the form (i a(z), b(z)) exp(ikx) in the plane of k and z.
  VectorXd frequencies(double k, double poisson) const {
    const double lame = 2 * poisson / (1 - 2 * poisson);
    const auto W = weight.asDiagonal();
    MatrixXd K(2 * n, 2 * n), M = MatrixXd::Zero(2 * n, 2 * n);
    const MatrixXd mass = value.transpose() * W * value, bend = slope.transpose() * W * slope,
                   mixed = value.transpose() * W * slope;
    K.topLeftCorner(n, n) = (lame + 2) * k * k * mass + bend;
    K.bottomRightCorner(n, n) = (lame + 2) * bend + k * k * mass;
    K.topRightCorner(n, n) = -lame * k * mixed + k * mixed.transpose();
    K.bottomLeftCorner(n, n) = K.topRightCorner(n, n).transpose();
    M.topLeftCorner(n, n) = M.bottomRightCorner(n, n) = mass;
    return Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(K, M, Eigen::EigenvaluesOnly)
        .eigenvalues()
        .cwiseMax(0)
        .cwiseSqrt();
  }

  /// Modes below ω on each unit of area of a large plate: ∫ k dk/2π over all branches.
  double modes(double omega, double poisson) const {
    double sum = 0;
    for (int m = 0; m * pi < omega; ++m) sum += (omega * omega - m * m * pi * pi) / 2;  // shear in the plane
    // No wave is slower than bending waves of thin plates or, at high frequencies, 0.8 c_t.
    const double most = omega / 0.8 + 2 * std::sqrt(omega), step = most / 240;
    for (double k = step / 2; k < most; k += step)
      sum += k * step * static_cast<double>((frequencies(k, poisson).array() < omega).count());
    return sum / (2 * pi);
  }
};

TEST(ExpectedModes, of_a_plate_are_those_of_waves_between_free_surfaces) {
  const Across across;
  for (const double poisson : {0.0, 0.3, 0.45})
    for (const double omega : {0.1, 0.5, 1.5, 2.5, 3.5, 6.0, 10.0}) {
      SCOPED_TRACE(testing::Message() << poisson << ", " << omega);
      // ρ = μ = h = 1: c² = E/ρ = 2 (1 + ν). Its sides are so long that it has no edges.
      const double side = 1e4;
      const ExpectedCount expected =
          expected_count({side * side, 2 * side * side, side}, std::sqrt(2 * (1 + poisson)), poisson);
      // The laws of thin and thick plates differ by this much from the count, which jumps where waves across
      // the thickness begin to travel.
      EXPECT_NEAR(expected(omega * omega) / (side * side) / across.modes(omega, poisson), 1, 0.12);
    }
}

TEST(ExpectedModes, of_a_rod_are_those_of_its_characteristic_equations) {
  // A square section of side 1, 100 long, with E = ρ = 1 and ν = 0.3. J = 0.1406 (Timoshenko & Goodier 1951).
  const double l = 100, section = 1, second = 1.0 / 12, shear = 1 / 2.6, twist = 0.1406, polar = 1.0 / 6;
  const ExpectedCount expected = expected_count({l, 4 * l + 2, l}, 1, 0.3);
  const auto count = [&](double omega) {
    double sum = 0;
    for (int n = 1; n < 1000; ++n) {
      // Bending: cosh x cos x = 1 next to (n + ½)π, which is the root to 1e-3 from n = 2 on.
      const double x = n == 1 ? 4.730 : (n + 0.5) * pi;
      sum += 2 * (x * x / (l * l) * std::sqrt(second / section) < omega);
      sum += n * pi / l < omega;
      sum += n * pi / l * std::sqrt(shear * twist / polar) < omega;
    }
    return sum;
  };
  // Whole numbers of four families are smaller than the estimate by half a mode each, and free ends take
  // another half of each of the two of bending: 3, within half a mode for each family. Rotary inertia and
  // shear, which these equations leave out, add up to a tenth for wavelengths of six sides, the shortest
  // here.
  for (const double omega : {0.01, 0.03, 0.1, 0.3})
    EXPECT_NEAR(expected(omega * omega), count(omega) + 3, 2 + 0.1 * count(omega)) << omega;
}

TEST(ExpectedModes, increase_with_frequency_for_bodies_of_any_shape) {
  for (const Extent& extent :
       {Extent{1, 6, 1}, Extent{1, 4.84, 1.3}, Extent{1e-4, 2, 1}, Extent{1e-6, 4e-3, 1}, Extent{.length = 1},
        box_of(1, std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 2})}) {
    const ExpectedCount expected = expected_count(extent, 1, 0.3);
    double last = 0;
    for (double lambda = 1e-6; lambda < 1e6; lambda *= 1.3) {
      const double now = expected(lambda);
      EXPECT_GT(now, last);
      EXPECT_TRUE(std::isfinite(now));
      last = now;
    }
  }
}

TEST(ExpectedModes, of_a_box_follow_from_its_inertia) {
  const double a = 0.3, b = 0.2, c = 0.1, mass = 5, by = mass / 12;
  const Extent box = box_of(mass, std::vector<double>{by * (b * b + c * c), 0, 0, 0, by * (a * a + c * c), 0,
                                                      0, 0, by * (a * a + b * b)});
  EXPECT_NEAR(box.volume, a * b * c, 1e-15);
  EXPECT_NEAR(box.surface, 2 * (a * b + b * c + c * a), 1e-14);
  EXPECT_NEAR(box.length, a, 1e-14);
  const Extent rod = box_of(mass, std::vector<double>{0, 0, 0, 0, by * a * a, 0, 0, 0, by * a * a});
  EXPECT_NEAR(rod.length, a, 1e-14);
  EXPECT_EQ(rod.surface, 0);
}

}  // namespace expected_modes_test
}  // namespace ricochet::kernels
