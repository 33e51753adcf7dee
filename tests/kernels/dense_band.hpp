// SPDX-License-Identifier: BSD-2-Clause
// Modes restricted to the contact surface, and their flexibilities as dense complex matrices.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "kernels/band.hpp"

namespace ricochet::kernels::test_band {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

using Choice = std::vector<bool>;
using Order = std::vector<std::size_t>;
using Random = std::mt19937_64;

inline constexpr RadPerSecond band{6000};

/// Modes with B as a dense matrix, one column per mode.
struct Set {
  VectorXd lambda;
  MatrixXd trace;  ///< (c, n)

  Index size() const { return lambda.size(); }
  BandModes modes() const {
    return {{lambda.data(), static_cast<std::size_t>(lambda.size())},
            {trace.data(), static_cast<std::size_t>(trace.size())}};
  }
  Set of(const Order& columns) const { return {lambda(columns), trace(Eigen::all, columns)}; }
  Set of(const Choice& chosen) const {
    Order columns;
    for (std::size_t k = 0; k < chosen.size(); ++k)
      if (chosen[k]) columns.push_back(k);
    return of(columns);
  }
  Set without(Choice left_out) const {
    left_out.flip();
    return of(left_out);
  }

  /// H(s) = Σ B_n B_nᵀ / (λ_n + s²)
  MatrixXcd flexibility(std::complex<double> s) const {
    MatrixXcd sum = MatrixXcd::Zero(trace.rows(), trace.rows());
    for (Index n = 0; n < size(); ++n)
      sum += (trace.col(n) * trace.col(n).transpose()).cast<std::complex<double>>() / (lambda[n] + s * s);
    return sum;
  }
};

/// Modes with frequencies from far below to far above the end of the band.
inline Set random_set(Random& random, Index c, Index n) {
  std::uniform_real_distribution<double> decade(-1.3, 1);
  std::normal_distribution<double> normal;
  Set set{VectorXd(n), MatrixXd(c, n)};
  for (double& lambda : set.lambda.reshaped())
    lambda = std::pow(band.value * std::pow(10, decade(random)), 2);
  for (double& entry : set.trace.reshaped()) entry = normal(random);
  return set;
}

/// The modes of `set`, each slightly perturbed.
inline Set nearly(Random& random, Set set, double off) {
  std::normal_distribution<double> normal;
  for (double& lambda : set.lambda.reshaped()) lambda *= 1 + off * std::abs(normal(random));
  for (double& entry : set.trace.reshaped()) entry += off * normal(random);
  return set;
}

/// Samples s on the ray, evenly spaced up to the end of the band.
inline std::vector<std::complex<double>> ray(int count = 24) {
  std::vector<std::complex<double>> places;
  for (int k = 1; k <= count; ++k) places.push_back(std::polar(band.value * k / count, std::numbers::pi / 4));
  return places;
}

/// The largest ‖H_coarse − H_fine‖ / ‖H_fine‖.
inline double dense_error(const Set& coarse, const Set& fine, bool quasi_static, int count = 24) {
  double worst = 0;
  for (const std::complex<double> s : ray(count)) {
    MatrixXcd flexibility = coarse.flexibility(s);
    if (quasi_static) flexibility += fine.flexibility(0) - coarse.flexibility(0);
    const MatrixXcd exact = fine.flexibility(s);
    worst = std::max(worst, (flexibility - exact).norm() / exact.norm());
  }
  return worst;
}

inline double dense_error_without(const Set& set, const Choice& left_out, int count = 24) {
  return dense_error(set.without(left_out), set, true, count);
}

}  // namespace ricochet::kernels::test_band
