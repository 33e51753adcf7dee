// SPDX-License-Identifier: BSD-2-Clause
// Properties of every model and step: bounded energy, contact
// conditions, a closed ledger, no heap allocation.
#include "contact/stepping/stepper.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "ricochet/error.hpp"
#include "tests/contact/falling_body.hpp"
#include "tests/contact/heap_counter.hpp"

namespace stepper_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;

/// Largest number of steps that are predicted together.
constexpr std::size_t longest_block = 24;

void add_damping(Model& model, double ratio, double rigid) {
  model.decay = ratio * model.omega;
  model.decay(0) = rigid;
}

/// Largest deviation of the ledger from its initial value, relative to the largest energy during the run.
double ledger_error(const Model& model, const StepOptions& options, int steps) {
  const auto stepper = make_stepper(model, options);
  const double start = stepper->modal()->energy().ledger();
  double worst = 0, size = stepper->modal()->energy().total();
  for (int k = 0; k < steps; ++k) {
    EXPECT_EQ(stepper->step(), StepStatus::ok) << k;
    size = std::max(size, stepper->modal()->energy().kinetic + stepper->modal()->energy().strain);
    worst = std::max(worst, std::abs(stepper->modal()->energy().ledger() - start));
  }
  EXPECT_GT(stepper->modal()->energy().damping, 0.01 * size);
  return worst / size;
}

// 1e-10: 1e5 steps with a round-off of ε = 2e-16 that may always have the same
// sign, and a margin for the number of modes.
TEST(Ledger, closes_over_a_hundred_thousand_steps_of_a_bouncing_damped_body) {
  Model model = dropped(12, 3, 1e-3);
  add_damping(model, 0.002, 0.05);
  for (const double step : {1 / 44100.0, 1e-4})
    EXPECT_LT(ledger_error(model, {.contact = {.scheme = Scheme::compliant}, .step = step}, 100000), 1e-10);
  for (const Admittance admittance : {Admittance::jump, Admittance::difference})
    EXPECT_LT(
        ledger_error(model,
                     {.contact = {.scheme = Scheme::impulse, .admittance = admittance, .restitution = 0.5},
                      .step = 1 / 44100.0},
                     100000),
        1e-10);
}

TEST(Ledger, closes_for_modes_damped_below_at_and_above_critical) {
  for (const double ratio : {0.3, 0.95, 1.0, 1.05, 4.0}) {
    Model model = dropped(8, 2, 1e-3);
    add_damping(model, ratio, 0);
    EXPECT_LT(ledger_error(model, {.contact = {.scheme = Scheme::compliant}, .step = 1e-4}, 20000), 1e-11)
        << ratio;
  }
}

/// Random bodies: rigid and elastic modes over four decades, R absent or of any
/// size, initial velocities in all modes.
Model random_model(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal;
  const Eigen::Index modes = 1 + static_cast<Eigen::Index>(15 * unit(random)),
                     points = 1 + static_cast<Eigen::Index>(8 * unit(random));
  Model model = blank(modes, points);
  for (Eigen::Index n = 0; n < modes; ++n) {
    model.omega(n) = unit(random) < 0.2 ? 0 : std::pow(10, 4 * unit(random));
    model.decay(n) = unit(random) < 0.5 ? 0 : std::pow(10, 3 * unit(random) - 2) * (model.omega(n) + 0.1);
    model.v0(n) = normal(random);
    for (Eigen::Index i = 0; i < points; ++i) model.B(i, n) = normal(random);
    model.load(n) = unit(random) < 0.5 ? 0 : normal(random);
  }
  model.omega(0) = 1e4;  // gives the shortest period
  if (unit(random) < 0.6) {
    const Matrix A = Matrix::NullaryExpr(points, points, [&] { return normal(random); });
    model.R = std::pow(10, -8 * unit(random)) * A * A.transpose();
    model.has_residual = true;
  }
  for (Eigen::Index i = 0; i < points; ++i) model.gap(i) = unit(random) < 0.5 ? 0 : 1e-3 * unit(random);
  return model;
}

// The energy theorems of the compliant scheme, for any B, ω, δ, R and Δ. By backward Euler, the energy never
// grows. In conserving steps, it never exceeds what was there at the start. 1e-12: round-off of one step.
void expect_energy_bound(ContactStep law) {
  std::mt19937 random(7);
  const double shortest = 2 * std::numbers::pi / 1e4;
  long touches = 0;
  for (double step = 1e-9 * shortest; step < 2e3 * shortest; step *= 10)
    for (int trial = 0; trial < 20; ++trial) {
      Model model = random_model(random);
      // Premise of the theorem: no overlap at the start, including the
      // static displacement of modes moved into R.
      model.gap = model.gap.cwiseMax(
          make_stepper(model, {.contact = {.scheme = Scheme::compliant}, .step = step})->displacement());
      const auto stepper =
          make_stepper(model, {.contact = {.scheme = Scheme::compliant, .integration = law}, .step = step});
      // The solver satisfies u ≤ g to the round-off of its largest term, size_u, and the energy is
      // accurate to λ times this round-off. The prediction of a look-ahead block sums the
      // responses to all forces of the block.
      const Vector softest =
          model.omega.unaryExpr([&](double w) { return std::min(0.5 * step * step, 2 / (w * w)); });
      const Matrix size_B = model.B.cwiseAbs();
      const Matrix size_S = size_B * softest.asDiagonal() * size_B.transpose() + Matrix(model.R.cwiseAbs());
      Vector force_before = stepper->force();
      std::deque<Vector> of_block(longest_block, Vector::Zero(force_before.size()));
      double before = stepper->modal()->energy().total();
      for (int k = 0; k < 200; ++k) {
        ASSERT_EQ(stepper->step(), StepStatus::ok) << "step " << step << " trial " << trial << " k " << k;
        const Vector force = stepper->force(), u = stepper->displacement();
        of_block.pop_front();
        of_block.push_back(force);
        Vector forces = force_before;
        for (const Vector& one : of_block) forces += one;
        const Vector size_u = size_B * (stepper->modal()->q + step * stepper->modal()->v).cwiseAbs() +
                              model.gap + size_S * forces;
        const Energy& e = stepper->modal()->energy();
        const double size = e.kinetic + e.strain + e.residual + std::abs(e.loads) +
                            (force + force_before).sum() * size_u.maxCoeff();
        ASSERT_LE(e.total() - before, 1e-12 * size) << "step " << step << " trial " << trial << " k " << k;
        if (law == ContactStep::backward_euler) before = e.total();
        ASSERT_GE(e.contact, -1e-12 * size) << "step " << step << " trial " << trial << " k " << k;
        force_before = force;
        touches += stepper->active();
        ASSERT_GE(force.minCoeff(), 0);
        ASSERT_LE((u - model.gap).maxCoeff(), 1e-12 * size_u.maxCoeff())
            << "step " << step << " trial " << trial << " k " << k;
      }
    }
  EXPECT_GT(touches, 10000);
}

TEST(Compliant, energy_never_grows_by_backward_euler_and_points_never_overlap) {
  expect_energy_bound(ContactStep::backward_euler);
}

TEST(Compliant, contact_never_puts_energy_in_by_conserving_steps_and_points_never_overlap) {
  expect_energy_bound(ContactStep::conserving);
}

TEST(Compliant, reports_the_displacement_and_force_of_its_own_state) {
  Model model = dropped(12, 3, 1e-4);
  model.static_displacement << 1e-6, -2e-6, 0;
  const auto stepper = make_stepper(model, {.contact = {.scheme = Scheme::compliant}, .step = 1 / 44100.0});
  int touching = 0;
  for (int k = 0; k < 2000; ++k) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    const Vector u =
        model.B * stepper->modal()->q + model.static_displacement - model.R * stepper->end_force();
    ASSERT_LT((u - stepper->displacement()).cwiseAbs().maxCoeff(), 1e-15);
    ASSERT_EQ(stepper->active(), (stepper->end_force().array() > 0).count());
    ASSERT_LT((stepper->end_force().array() * (model.gap - u).array()).abs().maxCoeff(), 1e-11);
    touching += stepper->active() > 0;
  }
  EXPECT_GT(touching, 10);
}

// A rigid body on the spring 1/R: it rebounds at its own speed after half a period, π √(m R), and its force
// is a half sine with the peak v √(m/R). Contact may begin anywhere within a step. A second-order step of
// 1/25 of the contact errs by about (π/25)²/12 = 1.3e-3; backward Euler loses a fifth of the energy.
TEST(Compliant, conserving_steps_let_a_body_rebound_from_a_spring) {
  const double speed = 0.5, R = 1e-7, duration = std::numbers::pi * std::sqrt(mass * R);
  for (const double phase : {0.1, 0.5, 0.9}) {
    Model model = dropped(1, 1, (1 + phase) * speed * duration / 25);
    model.load.setZero();
    model.v0(0) = speed * std::sqrt(mass);
    model.R(0, 0) = R;
    double rebound[2] = {}, peak = 0, touch = 0;
    for (const ContactStep law : {ContactStep::conserving, ContactStep::backward_euler}) {
      const auto stepper = make_stepper(model, {.contact = {.integration = law}, .step = duration / 25});
      for (int k = 0; k < 40; ++k) {
        ASSERT_EQ(stepper->step(), StepStatus::ok);
        if (law == ContactStep::backward_euler) continue;
        peak = std::max(peak, stepper->force()(0));
        touch += stepper->active() * stepper->options().step;
      }
      rebound[law == ContactStep::backward_euler] = -stepper->modal()->v(0) / std::sqrt(mass) / speed;
    }
    EXPECT_NEAR(rebound[0], 1, 5e-3) << phase;
    EXPECT_LE(rebound[0], 1 + 1e-12) << phase;
    EXPECT_LT(rebound[1], 0.95) << phase;
    EXPECT_NEAR(peak, speed * std::sqrt(mass / R), 0.02 * peak) << phase;
    EXPECT_NEAR(touch, duration, 1.5 * duration / 25) << phase;
  }
}

TEST(Compliant, carries_the_weight_of_a_body_at_rest) {
  Model model = dropped(12, 3, 0);
  model.R = 1e-7 * Matrix::Identity(3, 3);
  add_damping(model, 0.05, 0);
  const auto stepper = make_stepper(model, {.contact = {.scheme = Scheme::compliant}, .step = 1e-4});
  for (int k = 0; k < 50000; ++k) ASSERT_EQ(stepper->step(), StepStatus::ok);
  EXPECT_NEAR(stepper->force().sum(), mass * gravity,
              1e-6);  // modes at 300 rad/s and ζ = 0.05 are at rest after 5 s
  EXPECT_LT(stepper->displacement().maxCoeff(), 1e-12);
}

// Ten modes lie above half the step rate. The stepper moves them into R and s, as the reference does by hand.
TEST(Compliant, moves_modes_that_a_step_cannot_sample_into_the_residual) {
  const double step = 1e-3;  // π/Δ = 3141.6: the modes at 3300, 3600, … are moved
  Model whole = dropped(21, 3, 1e-3);
  whole.load.tail(20).setConstant(0.3);
  Model by_hand = dropped(21, 3, 1e-3);
  by_hand.load = whole.load;
  const Eigen::Index kept = 11;
  for (Eigen::Index n = kept; n < 21; ++n) {
    const Vector b = whole.B.col(n) / whole.omega(n);
    by_hand.R += b * b.transpose();
    by_hand.static_displacement += b * (whole.load(n) / whole.omega(n));
  }
  for (Vector* x : {&by_hand.omega, &by_hand.decay, &by_hand.load, &by_hand.q0, &by_hand.v0})
    x->conservativeResize(kept);
  by_hand.B = Matrix(by_hand.B.leftCols(kept));
  const auto one = make_stepper(whole, {.contact = {.scheme = Scheme::compliant}, .step = step});
  const auto other = make_stepper(by_hand, {.contact = {.scheme = Scheme::compliant}, .step = step});
  EXPECT_EQ(one->modal()->modes_in_residual(), 10);
  EXPECT_EQ(other->modal()->modes_in_residual(), 0);
  int touching = 0;
  for (int k = 0; k < 200; ++k) {
    ASSERT_EQ(one->step(), StepStatus::ok);
    ASSERT_EQ(other->step(), StepStatus::ok);
    // Force error: a displacement of 1e-15 times a stiffness of 1e7, amplified by bounces.
    ASSERT_LT((one->force() - other->force()).cwiseAbs().maxCoeff(), 1e-5);
    ASSERT_LT((one->modal()->q.head(kept) - other->modal()->q).cwiseAbs().maxCoeff(), 1e-11);
    ASSERT_EQ(one->modal()->q.tail(10), Vector::Zero(10));
    touching += one->active() > 0;
  }
  EXPECT_GT(touching, 10);
}

TEST(Compliant, refuses_a_body_squeezed_into_less_than_its_room_and_keeps_its_state) {
  Model model = blank(1, 2);
  model.B << 1, -1;
  model.gap.setConstant(-1);
  model.v0(0) = 1;
  const auto stepper = make_stepper(model, {.contact = {.scheme = Scheme::compliant}, .step = 0.1});
  EXPECT_EQ(stepper->step(), StepStatus::no_solution);
  EXPECT_EQ(stepper->steps(), 0);
  EXPECT_EQ(stepper->modal()->q(0), 0);
  EXPECT_EQ(stepper->modal()->v(0), 1);
}

TEST(Stepper, reports_what_is_not_a_number) {
  for (const Scheme scheme : {Scheme::compliant, Scheme::impulse}) {
    Model model = dropped(3, 1, 1);
    model.load(2) = std::numeric_limits<double>::quiet_NaN();
    const auto stepper = make_stepper(model, {.contact = {.scheme = scheme}, .step = 1e-4});
    EXPECT_EQ(stepper->step(), StepStatus::not_finite);
    EXPECT_EQ(stepper->steps(), 0);
  }
}

// Contact problems do not contain a mode that moves no point; only its energy shows that it is not finite.
TEST(Stepper, reports_what_is_not_a_number_in_a_mode_that_moves_no_point) {
  const std::vector<StepOptions> schemes{
      {.contact = {.scheme = Scheme::compliant}, .step = 1e-4, .block = 1},
      {.contact = {.scheme = Scheme::compliant}, .step = 1e-4},
      {.contact = {.scheme = Scheme::impulse}, .step = 1e-4},
      {.contact = {.scheme = Scheme::impulse, .instant = Instant::exact}, .step = 1e-4}};
  const auto status = [](const Model& model, const StepOptions& options) {
    const auto stepper = make_stepper(model, options);
    const StepStatus first = stepper->step();
    EXPECT_EQ(stepper->steps(), first == StepStatus::ok ? 1 : 0);
    return first;
  };
  for (const StepOptions& options : schemes) {
    Model model = dropped(3, 1, 1);
    model.B.col(2).setZero();
    EXPECT_EQ(status(model, options), StepStatus::ok);
    Model loaded = model, fast = model, bent = model;
    loaded.load(2) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(status(loaded, options), StepStatus::not_finite);
    fast.v0(2) = 1e200;  // q̇² exceeds double precision
    EXPECT_EQ(status(fast, options), StepStatus::not_finite);
    bent.omega(2) = 1e-3;
    bent.q0(2) = 1e160;  // so does ω² q², but not q̇², as the velocity becomes 1e-10 q in one step
    EXPECT_EQ(status(bent, options), StepStatus::not_finite);
  }
}

TEST(Stepper, power_through_the_contact_sums_to_the_energy_it_takes) {
  for (const Scheme scheme : {Scheme::compliant, Scheme::impulse}) {
    Model model = dropped(12, 3, 1e-3);
    if (scheme == Scheme::compliant) model.R.setZero();  // with R, u̇ includes the motion of the residual
    const auto stepper = make_stepper(model, {.contact = {.scheme = scheme}, .step = 1e-4});
    double sum = 0;
    for (int k = 0; k < 3000; ++k) {
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      sum += stepper->persistency() * 1e-4;
    }
    EXPECT_GT(stepper->modal()->energy().contact, 1e-4);
    EXPECT_NEAR(-sum, stepper->modal()->energy().contact, 1e-10 * stepper->modal()->energy().contact);
  }
}

std::string complaint(const Model& model, const StepOptions& options) {
  try {
    const auto stepper = make_stepper(model, options);
  } catch (const ricochet::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Stepper, refuses_in_one_line_what_it_cannot_step) {
  const Model model = dropped(3, 1, 1);  // highest mode 600 rad/s = 95.493 Hz; π/600 = 0.005236 s
  const std::string difference = complaint(
      model, {.contact = {.scheme = Scheme::impulse, .admittance = Admittance::difference}, .step = 0.01});
  for (const char* part : {"difference", "omega_max * step = 6", "95.493 Hz", "below 0.005236 s", "jump"})
    EXPECT_NE(difference.find(part), std::string::npos) << part << " in: " << difference;
  EXPECT_EQ(difference.find('\n'), std::string::npos);
  EXPECT_EQ(complaint(model, {.contact = {.scheme = Scheme::impulse, .admittance = Admittance::difference},
                              .step = 0.0052}),
            "");
  EXPECT_EQ(complaint(model,
                      {.contact = {.scheme = Scheme::impulse, .admittance = Admittance::jump}, .step = 0.01}),
            "");
  EXPECT_NE(complaint(model, {.contact = {.scheme = Scheme::impulse, .restitution = 1.5}, .step = 0.001})
                .find("1.5"),
            std::string::npos);
  EXPECT_NE(complaint(model, {.contact = {.scheme = Scheme::compliant}, .step = 0}).find("time step = 0 s"),
            std::string::npos);
}

TEST(Stepper, steps_a_model_without_contact_points) {
  const auto stepper = make_stepper(dropped(3, 0, 1), {.step = 1e-3});
  for (int k = 0; k < 10; ++k) ASSERT_EQ(stepper->step(), StepStatus::ok);
  EXPECT_NEAR(stepper->modal()->v(0), std::sqrt(mass) * gravity * 0.01, 1e-15);
}

#if RICOCHET_HEAP_COUNTED
TEST(Stepper, takes_no_memory_in_ten_thousand_steps) {
  Model model = dropped(120, 30, 1e-4);
  add_damping(model, 0.01, 0);
  const double step = 1 / 44100.0;
  for (const StepOptions& options :
       {StepOptions{.contact = {.scheme = Scheme::compliant}, .step = step},
        StepOptions{.contact = {.scheme = Scheme::impulse}, .step = step},
        StepOptions{.contact = {.scheme = Scheme::impulse, .admittance = Admittance::difference},
        .step = step}}) {
    const auto stepper = make_stepper(model, options);
    int touching = 0;
    const long before = heap_counter::calls;
    for (int k = 0; k < 10000; ++k) {
      if (stepper->step() != StepStatus::ok) break;
      touching += stepper->active() > 0;
    }
    const long after = heap_counter::calls;
    EXPECT_EQ(after, before);
    EXPECT_EQ(stepper->steps(), 10000);
    EXPECT_GT(touching, 100);
  }
}
#endif

}  // namespace stepper_test
