// SPDX-License-Identifier: BSD-2-Clause
// Two equal elastic rods, represented by their exact modes, collide end to end. Wave solution: the ends
// move together at v/2 under the pressure Z v/2 until the waves return from the free ends at t = 2L/c = 20.
// Then the striking rod is at rest and the other one leaves at v. With ρ = A = E = 1, c = 1 and the
// impedance is Z = ρcA = 1; L = 10, v = 1.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "contact/stepping/stepper.hpp"

namespace rods_test {

using namespace ricochet::contact;
using ricochet::Admittance;
using ricochet::Scheme;
using ricochet::StepOptions;
using ricochet::StepStatus;

constexpr double length = 10, speed = 1, impedance = 1, step = 0.01, duration = 30;
constexpr double touching_time = 20;  // 2L/c
constexpr int modes = 100;            // modes of a rod: one rigid and 99 elastic ones

/// Modes cos(nπx/L) of a free rod of mass 10: φ_0 = 1/√10, |φ_n| = √(2/10) at an end, ω_n = nπ/10.
Model two_rods() {
  Model model;
  const Eigen::Index N = 2 * modes;
  model.omega = model.decay = model.load = model.q0 = model.v0 = Vector::Zero(N);
  model.B = Matrix::Zero(1, N);
  for (int rod = 0; rod < 2; ++rod)
    for (int n = 0; n < modes; ++n) {
      model.omega(rod * modes + n) = n * std::numbers::pi / length;
      model.B(0, rod * modes + n) = (rod == 0 ? 1 : -1) * std::sqrt((n == 0 ? 1 : 2) / length);
    }
  model.v0(0) = speed * std::sqrt(length);
  // Flexibility of the truncated modes: Σ_{n>99} φ_n²/ω_n², from Σ_{n≥1} 1/n² = π²/6.
  double rest = std::numbers::pi * std::numbers::pi / 6;
  for (int n = modes - 1; n >= 1; --n) rest -= 1.0 / (static_cast<double>(n) * n);
  const double tail = 2 / length * std::pow(length / std::numbers::pi, 2) * rest;
  model.R = Matrix::Constant(1, 1, 2 * tail);
  model.has_residual = true;
  model.gap = model.static_displacement = Vector::Zero(1);
  model.area = Vector::Ones(1);
  return model;
}

/// Mean velocity of a rod: the rate of its rigid mode divided by √mass.
double velocity(const Stepper& stepper, int rod) {
  return stepper.modal()->v(rod * modes) / std::sqrt(length);
}

struct Outcome {
  double exit_a = 0, exit_b = 0;
  double last_contact = 0;  ///< end of the last step with a force
  double impulse = 0;
  double early_mean = 0;        ///< mean force from t = 1 to t = 18
  double penetration = 0;       ///< largest penetration at step ends
  double penetration_rate = 0;  ///< mean rate of penetration from t = 1 to t = 18
  double energy_lost = 0;       ///< relative loss of energy
  double energy_gain = 0;       ///< largest energy that contact has put in so far, relative
  double ledger = 0;            ///< largest relative deviation of the ledger
};

Outcome collide(const StepOptions& options) {
  const auto stepper = make_stepper(two_rods(), options);
  const double initial = stepper->modal()->energy().total();
  double before = initial, at_1 = 0, at_18 = 0;
  Outcome out;
  for (int k = 1; k <= std::lround(duration / options.step); ++k) {
    EXPECT_EQ(stepper->step(), StepStatus::ok);
    const double t = stepper->time(), force = stepper->force()(0), total = stepper->modal()->energy().total();
    out.impulse += force * options.step;
    if (t > 1 + 0.5 * options.step && t < 18 + 0.5 * options.step)
      out.early_mean += force * options.step / 17;
    if (std::abs(t - 1) < 0.5 * options.step) at_1 = stepper->displacement()(0);
    if (std::abs(t - 18) < 0.5 * options.step) at_18 = stepper->displacement()(0);
    if (force > 0) out.last_contact = t;
    out.penetration = std::max(out.penetration, stepper->displacement()(0));
    out.energy_gain = std::max(out.energy_gain, -stepper->modal()->energy().contact / initial);
    out.ledger = std::max(out.ledger, std::abs(stepper->modal()->energy().ledger() - initial) / initial);
    before = total;
  }
  out.exit_a = velocity(*stepper, 0);
  out.exit_b = velocity(*stepper, 1);
  out.penetration_rate = (at_18 - at_1) / 17;
  out.energy_lost = 1 - before / initial;
  return out;
}

TEST(RodsCompliant, exchange_their_velocities_at_the_exact_time_and_pressure) {
  const Outcome out = collide({.scheme = Scheme::compliant, .step = step});
  EXPECT_NEAR(out.exit_a, 0, 0.01);
  EXPECT_NEAR(out.exit_b, speed, 0.01);
  EXPECT_NEAR(out.last_contact, touching_time,
              0.15);  // the width of the wave front is the wavelength of the highest mode, 2L/99 = 0.2
  EXPECT_NEAR(out.impulse / touching_time, impedance * speed / 2, 0.005);
}

TEST(RodsCompliant, do_not_penetrate_and_hardly_lose_energy) {
  const Outcome out = collide({.scheme = Scheme::compliant, .step = step});
  EXPECT_LT(out.penetration, 1e-10);
  EXPECT_GE(out.energy_lost, 0);
  EXPECT_LT(out.energy_lost, 0.005);
  EXPECT_LT(out.energy_gain, 1e-12);
  EXPECT_LT(out.ledger, 1e-12);  // round-off of 3000 steps
}

// An impulse cancels the velocity only at t_k⁺. During the step, the force P/Δ makes u̇ grow
// by p Δ (Ṅ_a + Ṅ_b), so the ends creep at half of this velocity on average. p follows from
// v = p (1/Z_a + 1/Z_b) + p Δ (Ṅ_a + Ṅ_b)/2.
TEST(RodsImpulseJump, creep_at_the_steady_pressure_of_the_velocity_jump) {
  const Outcome out = collide({.scheme = Scheme::impulse, .admittance = Admittance::jump, .step = step});
  const double jump = (1 + 2 * (modes - 1)) / length;  // Ṅ(0⁺) of one rod
  const double pressure = speed / (2 / impedance + step * 2 * jump / 2);
  EXPECT_NEAR(pressure, 0.45475, 5e-6);
  EXPECT_NEAR(out.early_mean, pressure, 5e-4);
  EXPECT_NEAR(out.penetration_rate, pressure * step * 2 * jump / 2, 5e-4);
  EXPECT_LT(out.ledger, 1e-12);
  EXPECT_LE(out.energy_gain, 1e-12);
}

TEST(RodsImpulseDifference, press_as_the_waves_do_and_penetrate_less_than_a_step) {
  const Outcome out =
      collide({.scheme = Scheme::impulse, .admittance = Admittance::difference, .step = step});
  EXPECT_NEAR(out.early_mean, impedance * speed / 2,
              0.0025);  // half a per cent: the truncated wave front rings
  EXPECT_NEAR(out.impulse / touching_time, impedance * speed / 2, 0.0025);
  EXPECT_LE(out.penetration, speed * step * (1 + 1e-9));
  EXPECT_NEAR(out.exit_a, 0, 0.01);
  EXPECT_NEAR(out.exit_b, speed, 0.01);
  EXPECT_LT(out.energy_lost, 0.005);
  EXPECT_LT(out.ledger, 1e-12);
}

// The first instant of the impulse scheme is t_1. Ends that touch at t_0
// are stopped one step, and thus v Δ, late.
TEST(RodsImpulse, meet_first_at_the_end_of_the_first_step) {
  for (const Admittance admittance : {Admittance::jump, Admittance::difference}) {
    const auto stepper =
        make_stepper(two_rods(), {.scheme = Scheme::impulse, .admittance = admittance, .step = step});
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    EXPECT_NEAR(stepper->displacement()(0), speed * step, 1e-15);
    EXPECT_GT(stepper->force()(0), 0);
  }
}

}  // namespace rods_test
