// SPDX-License-Identifier: BSD-2-Clause
// The Coriolis force on nearly equal modes of bodies that turn.
#include "contact/motion/coriolis.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/contact/cloud.hpp"
#include "tests/drawn.hpp"

namespace ricochet::contact::test {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double omega = 2000;  // of the lowest modes [rad/s]

/// A cloud whose elastic modes have the frequencies ω times `share`, then others that are 2.1 % apart.
Cloud cloud_of(std::initializer_list<double> share) {
  Cloud cloud({0.1, 0.08, 0.06}, 500, 0, 4, true, 0.2, true);
  double other = 1.6;
  for (std::size_t n = 6; n < 81; ++n)
    cloud.kernel.modes.angular_frequency[n] =
        omega * (n < 6 + share.size() ? share.begin()[n - 6] : (other *= 1.021));
  cloud.couple();
  return cloud;
}

Drop flight(const Vector3d& spin) { return {.spin = spin, .height = 5, .gravity = {0, 0, 0}}; }

/// q and v of the elastic modes after a flight that begins with rates v.
struct Flown {
  VectorXd q, v;
  Flown(const Cloud& cloud, const Vector3d& spin, const VectorXd& rates, double rate, int steps,
        int per_sample = 1) {
    const auto model = over_floor(cloud, flight(spin));
    model->v0.tail(75) = rates;
    const auto stepper = make_stepper(model, stepping(rate, Rotation::finite, per_sample));
    while (stepper->steps() < steps)
      if (stepper->step() != StepStatus::ok) throw std::runtime_error("a flight failed");
    q = stepper->modal()->q.tail(75);
    v = stepper->modal()->v.tail(75);
  }
};

double energy(const Cloud& cloud, const VectorXd& q, const VectorXd& v) {
  const Eigen::Map<const VectorXd> own(cloud.kernel.modes.angular_frequency.data() + 6, 75);
  return 0.5 * (v.squaredNorm() + own.cwiseProduct(q).squaredNorm());
}

TEST(Coriolis, turns_without_energy) {
  const Cloud cloud = cloud_of({1, 1, 1.004, 1.01, 1.01, 1.025});
  ASSERT_GE(cloud.kernel.modes.coriolis.pair.size() / 2, 12);
  const auto model = over_floor(cloud, flight({0, 0, 0}));
  const Coriolis coriolis(*model, model->bodies[0]);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  VectorXd q(81), v(81);
  for (double& x : q) x = normal(random) / omega;
  for (double& x : v) x = normal(random);
  const VectorXd first_q = q, first_v = v;
  const auto strain = [&](const VectorXd& x) { return model->omega.cwiseProduct(x).squaredNorm(); };
  std::vector<Vector3d> angles(1000);
  for (Vector3d& angle : angles) {
    angle = 0.3 * ricochet::test::drawn(normal, random);
    coriolis.turn(angle, 1e-3, Coriolis::Half::before, q, v);
  }
  // 15 pairs · 1000 turns, each with some roundings
  EXPECT_NEAR(v.squaredNorm() / first_v.squaredNorm(), 1, 1e-13);
  EXPECT_NEAR(strain(q) / strain(first_q), 1, 1e-13);
  EXPECT_GT((v - first_v).head(12).tail(6).norm(), 0.5 * first_v.head(12).tail(6).norm());
  EXPECT_EQ(v.tail(69), first_v.tail(69));
  EXPECT_EQ(v.head(6), first_v.head(6));
  // The other half undoes a turn about the opposite angle.
  for (std::size_t k = angles.size(); k-- > 0;) coriolis.turn(-angles[k], 1e-3, Coriolis::Half::after, q, v);
  EXPECT_LT((v - first_v).norm(), 1e-12 * first_v.norm());
  EXPECT_LT((q - first_q).norm(), 1e-12 * first_q.norm());
}

/// The masses of a cloud, in world axes, with springs between them and a frame that turns steadily: Newton's
/// law, without any force of inertia. u = Aᵀx − X, and the force on mass k is −A (K u)_k.
struct Masses {
  Masses(const Cloud& cloud, const Vector3d& spin) : spin_(spin), at_(81), root_(81) {
    for (int k = 0; k < 27; ++k) {
      at_.segment<3>(3 * k) = cloud.place[static_cast<std::size_t>(k)] - cloud.centre;
      root_.segment<3>(3 * k).setConstant(cloud.weight[static_cast<std::size_t>(k)]);
    }
    const Eigen::MatrixXd momentum = root_.asDiagonal() * cloud.shape.rightCols(75);
    const Eigen::Map<const VectorXd> own(cloud.kernel.modes.angular_frequency.data() + 6, 75);
    of_modes_ = momentum.transpose();
    // M⁻¹ K
    pull_ = cloud.shape.rightCols(75) * own.cwiseAbs2().asDiagonal() * of_modes_;
  }

  Matrix3d frame(double t) const {
    return Eigen::AngleAxisd(spin_.norm() * t, spin_.normalized()).toRotationMatrix();
  }
  static VectorXd turned(const Matrix3d& by, const VectorXd& x) {
    return (by * x.reshaped(3, 27)).reshaped();
  }
  VectorXd acceleration(double t, const VectorXd& x) const {
    const Matrix3d A = frame(t);
    return -turned(A, pull_ * (turned(A.transpose(), x) - at_));
  }

  /// Coordinates q and v of the modes after `steps` of the rule of Runge, Kutta and Nyström.
  std::pair<VectorXd, VectorXd> fly(const Eigen::MatrixXd& shape, const VectorXd& rates, double h,
                                    int steps) const {
    VectorXd x = at_, v = turned(Matrix3d(cross_matrix(spin_)), at_) + shape * rates;
    for (int k = 0; k < steps; ++k) {
      const double t = h * k;
      const VectorXd a = acceleration(t, x), b = acceleration(t + h / 2, x + h / 2 * v + h * h / 8 * a),
                     c = acceleration(t + h, x + h * v + h * h / 2 * b);
      x += h * v + h * h / 6 * (a + 2 * b);
      v += h / 6 * (a + 4 * b + c);
    }
    const Matrix3d back = frame(h * steps).transpose();
    return {of_modes_ * (turned(back, x) - at_),
            of_modes_ * (turned(back, v) - turned(Matrix3d(cross_matrix(spin_)), at_))};
  }

 private:
  Vector3d spin_;
  VectorXd at_, root_;
  Eigen::MatrixXd of_modes_, pull_;
};

TEST(Coriolis, passes_energy_between_modes_as_the_masses_of_the_body_do) {
  const Cloud cloud = cloud_of({1, 1.0015, 1.003});
  ASSERT_EQ(cloud.kernel.modes.coriolis.pair.size() / 2, 3);
  const Vector3d spin = 0.003 * omega * cloud.steady_axis();
  constexpr double rate = 10'000;
  constexpr int steps = 1700;
  VectorXd rates = VectorXd::Zero(75);
  rates(0) = 1e-3;
  const Masses masses(cloud, spin);
  const Eigen::MatrixXd shape = cloud.shape.rightCols(75);
  // The masses alone also feel the centrifugal force.
  const auto [q1, v1] = masses.fly(shape, rates, 1 / rate, steps);
  const auto [q0, v0] = masses.fly(shape, VectorXd::Zero(75), 1 / rate, steps);
  const Flown flown(cloud, spin, rates, rate, steps);
  // The energies of the three modes, and the part of the second one in phase with the first.
  const auto shares = [&](const VectorXd& q, const VectorXd& v) {
    const Eigen::Map<const VectorXd> own(cloud.kernel.modes.angular_frequency.data() + 6, 3);
    const VectorXd x = own.cwiseProduct(q.head(3));
    const Eigen::Vector4d out(v(0) * v(0) + x(0) * x(0), v(1) * v(1) + x(1) * x(1), v(2) * v(2) + x(2) * x(2),
                              v(0) * v(1) + x(0) * x(1));
    return Eigen::Vector4d(out / 1e-6);
  };
  const Eigen::Vector4d expected = shares(q1 - q0, v1 - v0), found = shares(flown.q, flown.v);
  EXPECT_GT(std::abs(expected(3)), 0.3);
  EXPECT_GT(expected(1), 0.3) << expected.transpose();
  // Modes that are not nearly equal mix by about 2Ω/ω = 0.006, and (Ω/ω)² ωT = 0.003.
  EXPECT_LT((found - expected).norm(), 0.015) << found.transpose() << " for " << expected.transpose();
  EXPECT_NEAR(energy(cloud, flown.q, flown.v), 0.5e-6, 1e-12 * 0.5e-6);
}

TEST(Coriolis, does_not_depend_on_the_basis_of_a_multiple_mode) {
  Cloud cloud = cloud_of({1, 1});
  const Vector3d spin = 0.01 * omega * Vector3d(0.5, 1, -0.7);
  VectorXd rates = VectorXd::Zero(75);
  rates(0) = 1;
  const Flown one(cloud, spin, rates, 1e4, 2000);
  const Eigen::MatrixXd before = cloud.shape.rightCols(75);
  const Eigen::Rotation2Dd other(0.8);
  cloud.shape.middleCols(6, 2) = cloud.shape.middleCols(6, 2) * other.toRotationMatrix();
  cloud.couple();
  rates.head(2) = other.toRotationMatrix().transpose() * rates.head(2);
  const Flown two(cloud, spin, rates, 1e4, 2000);
  const VectorXd u = before * one.q, w = cloud.shape.rightCols(75) * two.q;
  EXPECT_LT((u - w).norm(), 1e-9 * before.col(0).norm() / omega);
  EXPECT_GT(std::hypot(one.v(1), omega * one.q(1)), 0.1);
}

/// Flights in one jump would be in step with the beat of the modes.
TEST(Coriolis, of_a_flight_does_not_depend_on_its_parts) {
  const Cloud cloud = cloud_of({1, 1.015});
  const Vector3d spin = 0.02 * omega * cloud.steady_axis();
  VectorXd rates = VectorXd::Zero(75);
  rates(0) = 1;
  const auto per_sample = static_cast<int>(std::lround(1e4 * 2 * std::numbers::pi / (0.015 * omega)));
  const int steps = 3 * per_sample;
  const Flown fine(cloud, spin, rates, 1e4, steps), coarse(cloud, spin, rates, 1e4, steps, per_sample);
  EXPECT_GT(std::abs(fine.v(1)), 0.02);
  EXPECT_LT((fine.v - coarse.v).norm(), 2e-3);
  EXPECT_LT(omega * (fine.q - coarse.q).norm(), 2e-3);
}

TEST(Coriolis, changes_no_bit_without_a_spin) {
  const Cloud cloud = cloud_of({1, 1, 1.01});
  Cloud apart = cloud;
  apart.kernel.modes.coriolis = {};
  VectorXd rates = VectorXd::LinSpaced(75, 1, 2);
  for (const int per_sample : {1, 50}) {
    const Flown one(cloud, Vector3d::Zero(), rates, 1e4, 200, per_sample),
        other(apart, Vector3d::Zero(), rates, 1e4, 200, per_sample);
    EXPECT_EQ(one.q, other.q);
    EXPECT_EQ(one.v, other.v);
  }
}

TEST(Coriolis, leaves_out_modes_that_it_hardly_mixes_or_that_steps_do_not_sample) {
  Cloud cloud = cloud_of({1, 1.01});
  const auto model = over_floor(cloud, flight({0, 0, 0}));
  const double g = Eigen::Map<const Vector3d>(cloud.kernel.modes.coriolis.coupling.data()).norm();
  const double mixed = 0.005 * 0.01 * omega / g;  // spin that mixes 1 % of the amplitude
  VectorXd q = VectorXd::Zero(81), v = VectorXd::Ones(81);
  const Vector3d axis = Eigen::Map<const Vector3d>(cloud.kernel.modes.coriolis.coupling.data()) / g;
  const VectorXd before = v;
  const Coriolis coriolis(*model, model->bodies[0]);
  coriolis.turn(0.99 * mixed * 0.5e-3 * axis, 1e-3, Coriolis::Half::before, q, v);
  EXPECT_EQ(v, before);
  coriolis.turn(1.01 * mixed * 0.5e-3 * axis, 1e-3, Coriolis::Half::before, q, v);
  EXPECT_NE(v, before);
  model->folded.modes = {7};
  EXPECT_TRUE(Coriolis(*model, model->bodies[0]).empty());
  cloud.support();
  EXPECT_TRUE(coriolis_of(*over_floor(cloud, flight({0, 0, 0})))[0].empty());
}

}  // namespace
}  // namespace ricochet::contact::test
