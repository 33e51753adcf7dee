// SPDX-License-Identifier: BSD-2-Clause
#include "src/scene/elastic_law.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace ricochet::scene {

namespace {

using Vector6 = std::array<double, 6>;
using Matrix6 = std::array<Vector6, 6>;  ///< symmetric

/// Smallest eigenvalue of a law over its largest one. With less, a third of the digits of a solution is lost.
constexpr double smallest_share = 1e-12;

struct Eigenpairs {
  Vector6 value{};
  Matrix6 vector{};  ///< columns
};

/// Jacobi's method. Its rotations leave entries that are zero between uncoupled components at zero.
Eigenpairs eigenpairs_of(Matrix6 a) {
  constexpr int most_sweeps = 50;
  Eigenpairs out;
  for (std::size_t k = 0; k < 6; ++k) out.vector[k][k] = 1;
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    bool turned = false;
    for (std::size_t p = 0; p < 6; ++p)
      for (std::size_t q = p + 1; q < 6; ++q) {
        if (std::abs(a[p][q]) <= 1e-17 * std::sqrt(std::abs(a[p][p] * a[q][q]))) continue;
        turned = true;
        const double half = (a[q][q] - a[p][p]) / (2 * a[p][q]),
                     t = std::copysign(1.0, half) / (std::abs(half) + std::hypot(half, 1.0)),
                     c = 1 / std::hypot(t, 1.0), s = t * c;
        const auto turn = [&](double& x, double& y) {
          const double old = x;
          x = c * old - s * y;
          y = s * old + c * y;
        };
        for (std::size_t k = 0; k < 6; ++k) turn(a[k][p], a[k][q]);
        for (std::size_t k = 0; k < 6; ++k) turn(a[p][k], a[q][k]);
        for (std::size_t k = 0; k < 6; ++k) turn(out.vector[k][p], out.vector[k][q]);
      }
    if (!turned) break;
  }
  for (std::size_t k = 0; k < 6; ++k) out.value[k] = a[k][k];
  return out;
}

Matrix6 inverse_of(const Matrix6& a) {
  const Eigenpairs pairs = eigenpairs_of(a);
  Matrix6 out{};
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j)
      for (std::size_t k = 0; k < 6; ++k)
        out[i][j] += pairs.vector[i][k] * pairs.vector[j][k] / pairs.value[k];
  return out;
}

Matrix6 compliance_of(const Orthotropy& law) {
  Matrix6 S{};
  for (std::size_t k = 0; k < 3; ++k) {
    S[k][k] = 1 / law.young[k];
    S[3 + k][3 + k] = 1 / law.shear[k];
  }
  S[1][2] = S[2][1] = -law.poisson[0] / law.young[1];
  S[0][2] = S[2][0] = -law.poisson[1] / law.young[0];
  S[0][1] = S[1][0] = -law.poisson[2] / law.young[0];
  return S;
}

Matrix6 filled(const std::array<double, 21>& upper) {
  Matrix6 C{};
  auto next = upper.begin();
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = i; j < 6; ++j) C[i][j] = C[j][i] = *next++;
  return C;
}

/// Of an anisotropic material.
Matrix6 compliance_of(const Material& material) {
  return material.stiffness ? inverse_of(filled(*material.stiffness)) : compliance_of(*material.orthotropy);
}

struct Moduli {
  double low, high;
};

/// Extreme Young's moduli of an anisotropic material, 1/E(n) = σᵀ S σ with the unit tension σ = n nᵀ.
Moduli extreme_young(const Material& material) {
  constexpr int quarter = 30;  // directions per quarter of a turn
  const Matrix6 S = compliance_of(material);
  Moduli out{std::numeric_limits<double>::infinity(), 0};
  for (int polar = 0; polar <= quarter; ++polar)
    for (int around = 0; around < 4 * quarter; ++around) {
      const double theta = polar * std::numbers::pi / (2 * quarter),
                   phi = around * std::numbers::pi / (2 * quarter), x = std::sin(theta) * std::cos(phi),
                   y = std::sin(theta) * std::sin(phi), z = std::cos(theta);
      const Vector6 stress{x * x, y * y, z * z, y * z, x * z, x * y};
      double strain = 0;
      for (std::size_t i = 0; i < 6; ++i)
        strain += stress[i] * std::inner_product(stress.begin(), stress.end(), S[i].begin(), 0.0);
      out = {std::min(out.low, 1 / strain), std::max(out.high, 1 / strain)};
    }
  return out;
}

struct Mean {
  double young, poisson;
};

/// Means of the compliance over all directions: 1/K = Σ S_ij over i, j ≤ 3, and 15/G = 4 Σ S_ii − 4 Σ S_ij +
/// 3 Σ S_kk over i < j ≤ 3 < k.
Mean mean_of(const Material& material) {
  if (material.isotropic()) return {material.young, material.poisson};
  const Matrix6 S = compliance_of(material);
  const double axial = S[0][0] + S[1][1] + S[2][2], across = S[0][1] + S[0][2] + S[1][2],
               shear = S[3][3] + S[4][4] + S[5][5];
  const double K = 1 / (axial + 2 * across), G = 15 / (4 * axial - 4 * across + 3 * shear);
  return {9 * K * G / (3 * K + G), (3 * K - 2 * G) / (2 * (3 * K + G))};
}

/// Whether two lists of numbers agree up to a few roundings of the largest one.
template <class List>
bool agree(const List& a, const List& b) {
  double largest = 0, apart = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    largest = std::max({largest, std::abs(a[k]), std::abs(b[k])});
    apart = std::max(apart, std::abs(a[k] - b[k]));
  }
  return apart <= 1e-12 * largest;
}

template <class Law, class Same>
bool both(const std::optional<Law>& a, const std::optional<Law>& b, const Same& same) {
  return a.has_value() == b.has_value() && (!a || same(*a, *b));
}

}  // namespace

std::array<double, 36> stiffness_of(const Material& material) {
  const Matrix6 C =
      material.stiffness ? filled(*material.stiffness) : inverse_of(compliance_of(*material.orthotropy));
  std::array<double, 36> out{};
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = C[k / 6][k % 6];
  return out;
}

std::optional<double> refused_eigenvalue(const Material& material) {
  if (material.isotropic()) return std::nullopt;
  const Vector6 values =
      eigenpairs_of(material.stiffness ? filled(*material.stiffness) : compliance_of(*material.orthotropy))
          .value;
  const auto [low, high] = std::ranges::minmax(values);
  if (low > smallest_share * high) return std::nullopt;
  return low;
}

double softest_young(const Material& material) {
  return material.isotropic() ? material.young : extreme_young(material).low;
}

double mean_poisson(const Material& material) { return mean_of(material).poisson; }

WaveSpeeds wave_speeds(const Material& material) {
  const double mean = std::sqrt(mean_of(material).young / material.density);
  if (material.isotropic()) return {mean, mean, mean};
  const auto [low, high] = extreme_young(material);
  return {std::sqrt(low / material.density), std::sqrt(high / material.density), mean};
}

WaveSpeeds wave_speeds(const Body& body) {
  WaveSpeeds out{std::numeric_limits<double>::infinity(), 0, 0};
  for (const Material& material : body.materials) {
    const auto [low, high, mean] = wave_speeds(material);
    out = {std::min(out.low, low), std::max(out.high, high), std::max(out.mean, mean)};
  }
  return out;
}

void stiffen(Material& material, double factor) {
  const auto multiply = [factor](auto& constants) {
    for (double& constant : constants) constant *= factor;
  };
  material.young *= factor;
  if (material.orthotropy) {
    multiply(material.orthotropy->young);
    multiply(material.orthotropy->shear);
  }
  if (material.stiffness) multiply(*material.stiffness);
}

double stiffness_ratio(const Material& had, const Material& wanted) {
  if (had.stiffness && wanted.stiffness) return wanted.stiffness->front() / had.stiffness->front();
  if (had.orthotropy && wanted.orthotropy) return wanted.orthotropy->young[0] / had.orthotropy->young[0];
  return wanted.young / had.young;
}

bool same_law(const Material& a, const Material& b) {
  const auto same_list = [](const auto& x, const auto& y) { return agree(x, y); };
  return a.poisson == b.poisson && agree(std::array{a.young}, std::array{b.young}) &&
         both(a.stiffness, b.stiffness, same_list) &&
         both(a.orthotropy, b.orthotropy,
              [](const Orthotropy& x, const Orthotropy& y) {
                return x.poisson == y.poisson && agree(x.young, y.young) && agree(x.shear, y.shear);
              }) &&
         a.axes == b.axes && both(a.about, b.about, [](const CentreLine& x, const CentreLine& y) {
           for (std::size_t k = 0; k < 3; ++k)
             if (std::abs(x.point[k] - y.point[k]) > 2e-12) return false;  // two roundings of a scaled place
           return x.direction == y.direction;
         });
}

}  // namespace ricochet::scene
