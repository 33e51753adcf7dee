// SPDX-License-Identifier: BSD-2-Clause
// A body of 27 masses, whose modes are exact, over a floor on which it may turn by any angle.
#pragma once

#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <random>

#include "contact/stepping/stepper.hpp"
#include "tests/contact/bodies.hpp"
#include "tests/drawn.hpp"
#include "tests/orthonormal.hpp"

namespace ricochet::contact::test {

/// A cloud of 27 masses, on a lattice of irregular spacing. Its modes are an exact M-orthonormal basis of all
/// its motions: six rigid ones, then 75 with frequencies from a list. The outer masses are candidates.
struct Cloud {
  std::vector<Vector3d> place;
  std::vector<double> weight;
  double mass = 0;
  Vector3d centre{0, 0, 0};
  Matrix3d inertia = Matrix3d::Zero();
  Eigen::MatrixXd shape;  ///< (81,N) of all masses, also of the one that is no candidate [kg^-1/2]
  kernels::Kernel kernel;

  /// @param lowest  frequency of the first elastic mode [Hz]  @param flexibility  R_ii [m/N], 0: no R
  /// @param irregular  share by which places and masses vary; 0: a box of equal masses, whose faces are flat
  /// @param swirl  whether the second elastic mode is the first one turned about the steady axis, nearly
  Cloud(const Vector3d& size, double lowest, double flexibility, unsigned seed, bool elastic = true,
        double irregular = 0.2, bool swirl = false) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> spread(1 - irregular, 1 + irregular);
    for (int k = 0; k < 27; ++k) {
      const Vector3d at(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
      place.push_back(0.5 * spread(random) * at.cwiseProduct(size));
      weight.push_back(0.01 * spread(random));
      mass += weight.back();
      centre += weight.back() * place.back();
    }
    centre /= mass;
    for (std::size_t k = 0; k < 27; ++k) {
      const Vector3d arm = place[k] - centre;
      inertia += weight[k] * (arm.squaredNorm() * Matrix3d::Identity() - arm * arm.transpose());
    }
    make_kernel(lowest, flexibility, random, elastic, swirl);
  }

  /// The principal axis with the largest moment, about which a free body spins steadily.
  Vector3d steady_axis() const {
    return Eigen::SelfAdjointEigenSolver<Matrix3d>(inertia).eigenvectors().col(2);
  }

  /// Adds the Coriolis coupling Σ m φ_m × φ_n of nearly equal modes, which may have new frequencies.
  void couple() {
    kernels::Coriolis& out = kernel.modes.coriolis = {};
    const std::vector<double>& omega = kernel.modes.angular_frequency;
    for (int m = 6; m < std::ssize(omega); ++m)
      for (int n = m + 1; n < std::ssize(omega); ++n) {
        if (omega[static_cast<std::size_t>(n)] >= 1.02 * omega[static_cast<std::size_t>(m)]) continue;
        Vector3d sum = Vector3d::Zero();
        for (int k = 0; k < 27; ++k)
          sum += weight[static_cast<std::size_t>(k)] *
                 Vector3d(shape.block<3, 1>(3 * k, m)).cross(Vector3d(shape.block<3, 1>(3 * k, n)));
        out.pair.insert(out.pair.end(), {m, n});
        out.coupling.insert(out.coupling.end(), sum.begin(), sum.end());
      }
  }

  /// Holds the body by springs, so that it has no rigid modes.
  void support() {
    kernel.supported = true;
    for (std::size_t n = 0; n < 6; ++n)
      kernel.modes.angular_frequency[n] = 300 * (1 + static_cast<double>(n));
  }

  /// Makes the inertia so large that nothing turns the body.
  void hold_attitude() {
    constexpr double times = 1e14;
    inertia *= times;
    for (double& x : kernel.inertia) x *= times;
    const auto modes = static_cast<std::size_t>(kernel.modes.size());
    for (std::size_t i = 0; i < kernel.surface.shape.size(); ++i)
      if (i % modes >= 3 && i % modes < 6) kernel.surface.shape[i] /= std::sqrt(times);
    for (std::size_t i = 0; i < kernel.loads.rotation.size(); ++i)
      if (i % modes >= 3 && i % modes < 6) kernel.loads.rotation[i] *= std::sqrt(times);
  }

 private:
  void make_kernel(double lowest, double flexibility, std::mt19937& random, bool elastic, bool swirl) {
    std::normal_distribution<double> normal;
    const int modes = elastic ? 81 : 6;
    // M^½ φ: the rigid motions, completed by any others, made orthonormal.
    Eigen::MatrixXd fields(81, 81);
    for (int k = 0; k < 27; ++k)
      for (int n = 0; n < 81; ++n) {
        const double root = std::sqrt(weight[static_cast<std::size_t>(k)]);
        const Vector3d arm = place[static_cast<std::size_t>(k)] - centre;
        Vector3d field = ricochet::test::drawn(normal, random);
        if (n < 3) field = Vector3d::Unit(n);
        if (n >= 3 && n < 6) field = Vector3d::Unit(n - 3).cross(arm);
        if (swirl && n == 7) field = steady_axis().cross(Vector3d(fields.block<3, 1>(3 * k, 6))) / root;
        fields.block<3, 1>(3 * k, n) = root * field;
      }
    const Eigen::MatrixXd basis = ricochet::test::orthonormal(fields);
    shape = basis.leftCols(modes);
    for (int k = 0; k < 81; ++k) shape.row(k) /= std::sqrt(weight[static_cast<std::size_t>(k / 3)]);
    kernel.body = "cloud";
    kernel.mass = mass;
    kernel.centre = {centre.x(), centre.y(), centre.z()};
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(kernel.inertia.data()) = inertia;
    for (int n = 0; n < modes; ++n)
      kernel.modes.angular_frequency.push_back(n < 6 ? 0
                                                     : 2 * std::numbers::pi * lowest * (1 + 0.1 * (n - 6)));
    kernel.modes.decay_rate.assign(static_cast<std::size_t>(modes), 0);
    for (int axis = 0; axis < 3; ++axis)
      for (int n = 0; n < modes; ++n) {
        Vector3d momentum = Vector3d::Zero(), angular = momentum;
        for (int k = 0; k < 27; ++k) {
          const double root = std::sqrt(weight[static_cast<std::size_t>(k)]);
          const Vector3d of_mass = root * basis.block<3, 1>(3 * k, n);
          momentum += of_mass;
          angular += place[static_cast<std::size_t>(k)].cross(of_mass);
        }
        kernel.loads.body_force.push_back(momentum(axis));
        kernel.loads.rotation.push_back(angular(axis));
      }
    // row-major (3,N): the loops above push one axis after the other
    for (int k = 0; k < 27; ++k) {
      if (k == 13) continue;
      const auto at = static_cast<std::size_t>(k);
      add_candidate(kernel, place[at], (place[at] - centre).normalized(), 1e-6);
      for (int axis = 0; axis < 3; ++axis)
        for (int n = 0; n < modes; ++n) kernel.surface.shape.push_back(shape(3 * k + axis, n));
    }
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {0, 2})
        for (int quad = 0; quad < 4; ++quad) add_quad(axis, side, quad % 2, quad / 2);
    if (!(flexibility > 0)) return;
    Eigen::MatrixXd factor(78, 78);
    for (double& x : factor.reshaped()) x = normal(random);
    const Eigen::MatrixXd R =
        flexibility * (0.5 * Eigen::MatrixXd::Identity(78, 78) + 0.5 * factor * factor.transpose() / 78);
    kernel.surface.residual_flexibility.assign(R.data(), R.data() + R.size());
  }

  /// Two triangles of a side of the lattice.
  void add_quad(int axis, int side, int u, int v) {
    const auto node = [&](int i, int j) {
      std::array<int, 3> at{};
      at[static_cast<std::size_t>(axis)] = side;
      at[static_cast<std::size_t>((axis + 1) % 3)] = u + i;
      at[static_cast<std::size_t>((axis + 2) % 3)] = v + j;
      return at[0] + 3 * at[1] + 9 * at[2];
    };
    const int p = node(0, 0), q = node(1, 0), r = node(1, 1), s = node(0, 1);
    for (std::array<int, 3> corner : {std::array{p, q, r}, std::array{p, r, s}}) {
      if (side == 0) std::swap(corner[1], corner[2]);
      const auto at = [&](std::size_t k) { return place[static_cast<std::size_t>(corner[k])]; };
      const Vector3d normal = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
      for (const int k : corner) {
        kernel.surface.element.push_back(k - (k > 13 ? 1 : 0));  // the mass in the middle is no candidate
        kernel.surface.element_normal.insert(kernel.surface.element_normal.end(), normal.begin(),
                                             normal.end());
      }
    }
  }
};

struct Drop {
  Matrix3d rotation = Matrix3d::Identity();
  Vector3d velocity{0, 0, 0}, spin{0, 0, 0};
  double height = 0;  ///< of the lowest candidate [m]
  std::optional<Friction> friction{};
  Vector3d gravity{0, 0, -9.81};
  bool turns = true;  ///< whether the model is for finite rotations
};

/// The cloud over the half-space z ≤ 0.
inline std::shared_ptr<Model> over_floor(const Cloud& cloud, const Drop& drop,
                                         const std::vector<ForcingRequest>& forcing = {}) {
  PlacedBody body{.name = "cloud", .kernel = &cloud.kernel, .rotation = drop.rotation};
  body.velocity = drop.velocity;
  body.angular_velocity = drop.spin;
  PairRequest pair{"cloud", "floor", {}, drop.height, {}};
  pair.friction = drop.friction;
  pair.everywhere = drop.turns;
  return std::make_shared<Model>(
      build_model({body}, {{.name = "floor", .normal = Vector3d::UnitZ()}}, {pair}, drop.gravity, forcing));
}

inline StepOptions stepping(double rate, Rotation rotation = Rotation::finite, int per_sample = 1) {
  return {.rigid = {.rotation = rotation}, .step = 1 / rate, .steps_per_sample = per_sample, .block = 1};
}

}  // namespace ricochet::contact::test
