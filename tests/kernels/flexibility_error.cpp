// SPDX-License-Identifier: BSD-2-Clause
// Kernels truncated to the modes that contact needs, compared with the response of a bar with many more
// modes.
#include <Eigen/Dense>
#include <complex>

#include "kernels/algebra.hpp"
#include "kernels/band.hpp"
#include "tests/kernels/bar.hpp"
#include "tests/kernels/sample.hpp"

namespace ricochet::kernels {
namespace flexibility_error_test {

using test::Bar;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// H(s) of a kernel, including R, on the ray s² = iω².
Eigen::MatrixXcd response(const Kernel& kernel, double omega) {
  const auto n = static_cast<Eigen::Index>(kernel.modes.size());
  const auto rows = static_cast<Eigen::Index>(kernel.surface.shape.size()) / n;
  const Eigen::Map<const RowMajor> shape(kernel.surface.shape.data(), rows, n);
  Eigen::MatrixXcd sum = Eigen::Map<const RowMajor>(kernel.surface.residual_flexibility.data(), rows, rows)
                             .cast<std::complex<double>>();
  for (Eigen::Index k = 0; k < n; ++k)
    sum += (shape.col(k) * shape.col(k).transpose()).cast<std::complex<double>>() /
           std::complex<double>(std::pow(kernel.modes.angular_frequency[static_cast<std::size_t>(k)], 2),
                                omega * omega);
  return sum;
}

/// Largest relative error of the response of a kernel up to `band`. The reference has 2000 modes, and its own
/// error is a thousand times below every bound in this file.
double error_of(const Kernel& kernel, RadPerSecond band) {
  static const Kernel truth = Bar{.modes = 2000}.kernel();
  double error = 0;
  for (int k = 1; k <= 24; ++k) {
    const double omega = band.value * k / 24;
    const Eigen::MatrixXcd exact = response(truth, omega);
    error = std::max(error, (response(kernel, omega) - exact).norm() / exact.norm());
  }
  return error;
}

TEST(TruncationToAFlexibilityError, reports_a_bound_of_the_error) {
  const Kernel whole = Bar{.modes = 60}.kernel();
  const RadPerSecond band{Bar{}.omega(6)};
  std::size_t last = 60;
  for (const double bound : {0.02, 0.05, 0.2}) {
    const Kernel cut = truncated_to_flexibility_error(whole, to_hertz(band), bound);
    EXPECT_NO_THROW(validate(cut, "origin"));
    EXPECT_LT(cut.modes.size(), last);
    last = cut.modes.size();
    const Certificate& reported = cut.modes.certificate;
    EXPECT_EQ(reported.count_found, 60);
    EXPECT_EQ(reported.left_out, 60 - static_cast<std::int64_t>(last));
    EXPECT_EQ(reported.upto_hz, whole.modes.certificate.upto_hz);
    EXPECT_LE(reported.flexibility_error, bound);
    EXPECT_LE(error_of(cut, band), reported.flexibility_error);
    EXPECT_GT(error_of(cut, band), reported.flexibility_error / 10);  // the bound is not loose
  }
}

// If the modes above the end may cause almost the entire error, little remains for the modes within the band.
TEST(TruncationToAFlexibilityError, includes_the_modes_above_the_end) {
  const RadPerSecond band{Bar{}.omega(6)};
  for (const std::size_t modes : {12U, 20U, 60U}) {
    const Kernel whole = Bar{.modes = modes}.kernel();
    const double above = error_above(whole, band, RadPerSecond(Hertz{whole.modes.certificate.upto_hz}));
    EXPECT_GE(above, error_of(whole, band));
    EXPECT_LE(above,
              5 * error_of(whole, band));  // most of these modes lie far above: Σ 1/n⁴ is 1/3 of Σ 1/n² / N²
    const Kernel cut = truncated_to_flexibility_error(whole, to_hertz(band), 1.05 * above);
    EXPECT_LE(cut.modes.certificate.flexibility_error, 1.05 * above);
    EXPECT_GE(cut.modes.certificate.flexibility_error, above);
    EXPECT_LE(error_of(cut, band), cut.modes.certificate.flexibility_error);
  }
}

}  // namespace flexibility_error_test
}  // namespace ricochet::kernels
