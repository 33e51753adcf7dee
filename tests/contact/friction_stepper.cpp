// SPDX-License-Identifier: BSD-2-Clause
// Steps with Coulomb friction against closed forms and conservation laws.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "contact/stepping/stepper.hpp"
#include "ricochet/error.hpp"
#include "tests/contact/sliding.hpp"

namespace friction_stepper_test {

using namespace ricochet;
using namespace ricochet::contact;
using namespace ricochet::contact::test;

constexpr double pi = std::numbers::pi;

std::unique_ptr<Stepper> steps_of(const Model& model, double step, int block = 1,
                                  ContactStep kind = ContactStep::conserving) {
  return make_stepper(model, {.contact = {.integration = kind}, .step = step, .block = block});
}

void advance(Stepper& stepper) { ASSERT_EQ(stepper.step(), StepStatus::ok); }

// A mass m that slides at V under the normal force F stops after m V / (μ F) and then stays. The force acts
// in full from the third step on: 1e-3 of the time is two steps.
TEST(Friction, stops_a_sliding_mass_after_the_time_of_Coulombs_law) {
  constexpr double mass = 2, V = 3, mu = 0.4, F = 5, stop = mass * V / (mu * F), step = stop / 2000;
  for (const int block : {1, 0})
    for (const ContactStep kind : {ContactStep::conserving, ContactStep::backward_euler}) {
      Model model = pressed(2, {mu, mu, 0}, F, 1e-6);
      model.B(2, 1) = 1 / std::sqrt(mass);
      model.B(1, 0) = 1 / std::sqrt(mass);
      model.v0 << 0.6 * V * std::sqrt(mass), 0.8 * V * std::sqrt(mass);
      const auto stepper = steps_of(model, step, block, kind);
      while (stepper->time() < 0.5 * stop) advance(*stepper);
      const Vector v = stepper->modal()->v / std::sqrt(mass);
      EXPECT_NEAR(v.norm(), 0.5 * V, 2e-3 * V);
      EXPECT_NEAR(v(0) / v(1), 0.75, 1e-12) << "friction acts against the slip";
      EXPECT_EQ(stepper->slip().states()[0], ContactState::slip);
      while (stepper->time() < 1.5 * stop) advance(*stepper);
      EXPECT_LT(stepper->modal()->v.norm(), 1e-9);
      EXPECT_EQ(stepper->slip().states()[0], ContactState::stick);
      const double distance = stepper->displacement().tail<2>().norm();
      EXPECT_NEAR(distance, V * stop / 2, 2e-3 * V * stop);
      EXPECT_NEAR(stepper->modal()->energy().friction, 0.5 * mass * V * V, 1e-3 * mass * V * V);
    }
}

// Without tangential motion of the rest, the impulse of friction is μ times that of the normal force,
// whatever the normal force does: here a mass that bounces on its own compliance.
TEST(Friction, impulse_is_mu_times_the_normal_impulse_while_a_point_slips) {
  constexpr double mu = 0.25;
  Model model = sliding(1, 2, {mu, mu, 0});
  model.R.diagonal().setConstant(1e-3);
  model.B(0, 0) = model.B(1, 1) = 1;
  model.gap(0) = 1e-3;
  model.v0 << 1, 10;
  const auto stepper = steps_of(model, 1e-3);
  bool touched = false;
  while (stepper->time() < 0.2) {
    advance(*stepper);
    touched = touched || stepper->active() > 0;
  }
  const Vector& v = stepper->modal()->v;
  EXPECT_TRUE(touched);
  EXPECT_LT(v(0), -0.99) << "it rebounds";
  EXPECT_NEAR(10 - v(1), mu * (1 - v(0)), 1e-13);
}

// A mass on a belt is dragged along: until it moves with the belt, it gains μ F t; the belt does the work.
TEST(Belt, drags_a_mass_up_to_its_own_speed) {
  constexpr double mass = 2, V = -3, mu = 0.4, F = 5, stop = mass * 3 / (mu * F), step = stop / 2000;
  for (const int block : {1, 0}) {
    Model model = pressed(1, {mu, mu, 0}, F, 1e-6);
    model.B(1, 0) = 1 / std::sqrt(mass);
    Vector slide = Vector::Zero(3);
    slide(1) = V;
    model.belts.push_back({"belt", slide, {{0, 1e3}, {0, 1e3}}});
    const auto stepper = steps_of(model, step, block);
    while (stepper->time() < 0.5 * stop) advance(*stepper);
    EXPECT_NEAR(stepper->modal()->v(0) / std::sqrt(mass), 0.5 * V, 2e-3 * std::abs(V));
    while (stepper->time() < 2 * stop) advance(*stepper);
    EXPECT_NEAR(stepper->modal()->v(0) / std::sqrt(mass), V, 1e-9);
    const Energy& energy = stepper->modal()->energy();
    // The belt does twice the work that the mass gains; the other half is heat.
    EXPECT_NEAR(energy.loads, mass * V * V, 2e-3 * mass * V * V);
    EXPECT_NEAR(energy.friction, 0.5 * mass * V * V, 2e-3 * mass * V * V);
    EXPECT_NEAR(energy.ledger(), 0, 1e-12 * mass * V * V);
  }
}

/// A rod of length 1 with ρ = c = A = 1 (so Z = 1) that moves along itself, with friction at its end x = 0.
Model rubbed_rod(int modes, double V, double limit) {
  Model model = pressed(modes, {1, 1, 0}, limit, 0);
  model.R(0, 0) = 1e-3;
  model.R(2, 2) = 1e-3;
  model.static_displacement(0) = 1e-3 * limit;
  double tail = 1.0 / 3;  // Σ 2/(nπ)² = 1/3
  for (int n = 0; n < modes; ++n) {
    model.omega(n) = n * pi;
    model.B(1, n) = n == 0 ? 1 : std::sqrt(2);
    if (n > 0) tail -= 2 / (n * n * pi * pi);
  }
  model.R(1, 1) = tail;
  model.v0(0) = V;
  return model;
}

// Characteristics: the end moves at w − F/Z, where w is twice the velocity of the wave that arrives there; it
// slips with |F| = 1 if |w| > 1, and sticks with F = w otherwise. The free end sends the wave back, so w
// falls by 2 F in each round trip of 2 L/c = 2: w = 4.5, 2.5, 0.5, −0.5, 0.5 …, and the end slips at 3.5
// and 1.5, then sticks.
TEST(RubbedRod, slips_and_sticks_when_the_characteristics_do) {
  std::vector<double> error_of_heat;
  for (const int steps : {50, 100, 200}) {  // for each round trip
    const double step = 2.0 / steps;
    const auto stepper = steps_of(rubbed_rod(2 * steps, 4.5, 1), step, 0);
    double stick = 0;
    while (stepper->time() < 8 - step / 2) {
      advance(*stepper);
      if (stepper->slip().states()[0] == ContactState::slip && stepper->time() < 5) stick = stepper->time();
      const double in_trip = std::fmod(stepper->time() - step / 2, 2.0);
      if (in_trip < 0.3 || in_trip > 1.7) continue;  // the front is spread over some steps
      const int trip = static_cast<int>(stepper->time() / 2);
      const double expected = std::vector{1.0, 1.0, 0.5, -0.5}[trip];
      // 1e-10: displacements hold to 1e-12; 5 %: the ripple after a front that a cut-off basis carries
      EXPECT_NEAR(stepper->force()(1), expected, trip < 2 ? 1e-10 : 0.05) << stepper->time();
    }
    EXPECT_NEAR(stick, 4, 2 * step);  // to the order of the step
    error_of_heat.push_back(std::abs(stepper->modal()->energy().friction - 2 * (3.5 + 1.5)) / 10);
  }
  EXPECT_LT(error_of_heat[2], 0.005);
  EXPECT_LT(error_of_heat[2], 0.6 * error_of_heat[0]);
}

// Stick-slip: a mass on a spring on a belt. The spring is drawn to μ_s F/k, slips under μ_d F and sticks
// again when its velocity is that of the belt: T = 2 (x_s − x_d)/v + 2 (π − atan(ω (x_s − x_d)/v))/ω.
TEST(StickSlip, has_the_limit_cycle_of_static_and_dynamic_friction) {
  constexpr double omega = 10, v = 0.5, F = 20, mu_s = 0.5, mu_d = 0.3, x_s = mu_s * F / (omega * omega),
                   x_d = mu_d * F / (omega * omega);
  const double stick = 2 * (x_s - x_d) / v, slip = 2 * (pi - std::atan(omega * (x_s - x_d) / v)) / omega;
  constexpr double step = 2e-5;
  for (const int block : {1, 0}) {
    Model model = pressed(1, {mu_s, mu_d, 1e-4 * v}, F, 1e-9);
    model.omega(0) = omega;
    model.B(1, 0) = 1;
    Vector slide = Vector::Zero(3);
    slide(1) = v;
    model.belts.push_back({"belt", slide, {{0, 1e3}, {0, 1e3}}});
    const auto stepper = steps_of(model, step, block);
    std::vector<double> starts;
    double slipping = 0, farthest = 0, nearest = 1;
    ContactState before = ContactState::stick;
    while (stepper->time() < 10 * (stick + slip)) {
      advance(*stepper);
      const ContactState now = stepper->slip().states()[0];
      if (now == ContactState::slip && before == ContactState::stick) starts.push_back(stepper->time());
      before = now;
      if (starts.size() < 3 || starts.size() > 6) continue;
      slipping += now == ContactState::slip ? step : 0;
      farthest = std::max(farthest, stepper->modal()->q(0));
      nearest = std::min(nearest, stepper->modal()->q(0));
    }
    ASSERT_GT(starts.size(), 7U);
    const double period = (starts[6] - starts[2]) / 4;
    // 5 steps: each transition is found to a step
    EXPECT_NEAR(period, stick + slip, 5 * step + 1e-3 * period);
    EXPECT_NEAR(slipping / 4, slip, 5 * step + 2e-3 * slip);
    EXPECT_NEAR(farthest, x_d + std::hypot(x_s - x_d, v / omega), 2e-3 * x_s);
    EXPECT_NEAR(nearest, x_d - std::hypot(x_s - x_d, v / omega), 2e-3 * x_s);
  }
}

// Stribeck: at a constant sliding speed, which a heavy mass keeps, the force is μ(v) F.
TEST(Stribeck, lowers_the_coefficient_with_the_sliding_speed) {
  constexpr double mass = 1e6, F = 3, mu_s = 0.6, mu_d = 0.2, v_s = 0.1;
  for (const double V : {0.01, 0.1, 0.2, 1.0}) {
    Model model = pressed(1, {mu_s, mu_d, v_s}, F, 1e-6);
    model.B(1, 0) = 1 / std::sqrt(mass);
    model.v0(0) = V * std::sqrt(mass);
    const auto stepper = steps_of(model, 1e-3);
    for (int k = 0; k < 10; ++k) advance(*stepper);
    const double mu = mu_d + (mu_s - mu_d) * std::exp(-(V / v_s) * (V / v_s));
    EXPECT_NEAR(stepper->force()(1), mu * F, 1e-4 * F) << V;
  }
}

// A forward slip that turns within a step may cost τ̄ d < 0. Summed over each slip, the heat stays ≥ 0.
TEST(Heat, of_every_slip_is_not_negative) {
  std::mt19937_64 random(7);
  for (int trial = 0; trial < 60; ++trial) {
    const Model model = random_body({.points = 1 + trial % 4,
                                     .modes = 8 + trial % 20,
                                     .friction = 0.2 + 0.1 * (trial % 10),
                                     .flexibility = std::pow(10.0, -1 - trial % 5),
                                     .frequency = 5.0 + 10 * (trial % 7)},
                                    random);
    const auto stepper = steps_of(model, 0.01);
    std::vector<double> heat(model.friction.size());  // of each slip so far
    Vector before = stepper->displacement();
    for (int k = 0; k < 400; ++k) {
      advance(*stepper);
      const Vector moved = stepper->displacement() - before;
      before = stepper->displacement();
      for (std::size_t f = 0; f < heat.size(); ++f) {
        const int t = model.friction[f].tangential;
        const Eigen::Vector2d force = stepper->force().segment<2>(t);
        if (stepper->slip().states()[f] == ContactState::stick || force.isZero(0)) {
          heat[f] = 0;
          continue;
        }
        heat[f] += force.dot(moved.segment<2>(t));
        // 1e-12: round-off of displacements, and the solver's tolerance
        ASSERT_GE(heat[f], -1e-12 * model.v0.squaredNorm()) << trial << ' ' << k;
      }
    }
  }
}

TEST(Heat, of_every_step_is_not_negative_with_backward_euler) {
  std::mt19937_64 random(8);
  double heat = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Model model = random_body(
        {.points = 1 + trial % 6, .modes = 8 + trial % 20, .friction = 0.1 * (trial % 12)}, random);
    const auto stepper = steps_of(model, 0.01, 1, ContactStep::backward_euler);
    const double energy = 0.5 * model.v0.squaredNorm();
    double before = 0;
    for (int k = 0; k < 300; ++k) {
      advance(*stepper);
      const double now = stepper->modal()->energy().friction;
      ASSERT_GE(now - before, -1e-13 * energy) << trial << ' ' << k;
      before = now;
    }
    heat = std::max(heat, before / energy);
  }
  EXPECT_GT(heat, 0.1);
}

// The entries of friction and contact come from the motion of the points, the energies from the modes. A
// force that drives the modes but is not the one at the points would leave a drift.
TEST(Ledger, closes_with_friction_belts_damping_and_loads) {
  std::mt19937_64 random(9);
  for (int trial = 0; trial < 40; ++trial) {
    Model model = random_body({.points = 1 + trial % 5,
                               .modes = 8 + trial % 20,
                               .friction = 0.1 + 0.1 * (trial % 9),
                               .damping = trial % 2 == 0 ? 0.02 : 0},
                              random);
    model.load(0) = 3;
    Vector slide = Vector::Zero(model.rows());
    for (const Model::FrictionPoint& point : model.friction) slide(point.tangential) = 0.7;
    model.belts.push_back({"belt", slide, {{0, 0.5, 1e3}, {0, 1, -3}}});
    for (const int block : {1, 0}) {
      const auto stepper = steps_of(model, 0.003, block);
      double scale = 0.5 * model.v0.squaredNorm();
      const double start = scale;
      for (int k = 0; k < 500; ++k) {
        advance(*stepper);
        const Energy& e = stepper->modal()->energy();
        scale = std::max({scale, std::abs(e.loads), std::abs(e.friction)});
        ASSERT_NEAR(e.ledger(), start, 1e-11 * scale) << trial << ' ' << k;
      }
      EXPECT_GT(stepper->modal()->energy().friction, 0);
    }
  }
}

TEST(Blocks, with_friction_give_the_forces_of_single_steps) {
  std::mt19937_64 random(10);
  for (int trial = 0; trial < 40; ++trial) {
    Model model = random_body({.points = 2 + trial % 20,
                               .modes = 10 + trial % 30,
                               .friction = 0.05 * (1 + trial % 10),
                               .flexibility = std::pow(10.0, -1 - trial % 4)},
                              random);
    if (trial % 3 == 0)
      for (Model::FrictionPoint& point : model.friction) point.law = {0.4, 0.2, 0.5};
    const auto single = steps_of(model, 0.004), blocks = steps_of(model, 0.004, 0);
    const auto sparse = make_stepper(model, {.step = 0.004, .every_state = false});
    double largest = 0;
    for (int k = 0; k < 300; ++k) {
      for (Stepper* stepper : {single.get(), blocks.get(), sparse.get()}) advance(*stepper);
      largest = std::max(largest, single->force().norm());
      // 1e-7: the solver's tolerance of 1e-12, grown by 300 steps of contact that repel each other
      ASSERT_LE((single->force() - blocks->force()).norm(), 1e-7 * largest) << trial << ' ' << k;
      ASSERT_LE((single->force() - sparse->force()).norm(), 1e-7 * largest) << trial << ' ' << k;
    }
    EXPECT_GT(largest, 0);
    ASSERT_EQ(sparse->catch_up(), StepStatus::ok);
    EXPECT_NEAR(sparse->modal()->energy().friction, single->modal()->energy().friction, 1e-7);
  }
}

TEST(Friction, is_refused_with_impulses) {
  const Model model = pressed(1, {0.3, 0.3, 0}, 1, 1e-6);
  EXPECT_THROW(make_stepper(model, {.contact = {.scheme = Scheme::impulse}, .step = 1e-3}), InputError);
}

// A clone continues bitwise, sliding speeds and heats of slips included.
TEST(Friction, continues_in_a_clone) {
  std::mt19937_64 random(11);
  Model model = random_body({.points = 4, .modes = 12}, random);
  for (Model::FrictionPoint& point : model.friction) point.law = {0.4, 0.2, 0.5};
  for (const int block : {1, 0}) {
    const auto stepper = steps_of(model, 0.004, block);
    while (stepper->active() == 0) advance(*stepper);
    const auto clone = stepper->clone();
    for (int k = 0; k < 100; ++k) {
      advance(*stepper);
      advance(*clone);
      ASSERT_EQ(stepper->force(), clone->force()) << k;
    }
  }
}

}  // namespace friction_stepper_test
