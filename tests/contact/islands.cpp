// SPDX-License-Identifier: BSD-2-Clause
// Bodies that never meet do not affect each other, and islands that merge and part gain no energy.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "contact/stepping/stepper.hpp"

namespace islands_test {

using namespace ricochet;
using namespace ricochet::contact;
using Eigen::Index;

constexpr double pi = std::numbers::pi;

/// A free rod of unit stiffness and density, as a body of a chain.
struct Rod {
  double length = 10, speed = 0;
};

/// A contact of the right end of rod a with the left end of rod b; −1: a wall.
struct Meeting {
  int a, b;
  double gap = 0;
  double side = 1;  ///< −1: the left end of a at a wall
};

/// The kernel of each rod has its rigid mode and N elastic ones, ω = nπ/L and φ = √(2/L) cos(nπx/L), and the
/// rest of the flexibility of its ends: Σ φφ/ω² over n > N.
Model chain_of(const std::vector<Rod>& rods, const std::vector<Meeting>& meetings, Index N = 90) {
  const auto count = static_cast<Index>(rods.size()), m = static_cast<Index>(meetings.size());
  Model model;
  for (Vector* x : {&model.omega, &model.decay, &model.load, &model.q0, &model.v0})
    x->setZero(count * (N + 1));
  model.B.setZero(m, count * (N + 1));
  model.R.setZero(m, m);
  model.has_residual = true;
  model.gap.setZero(m);
  model.static_displacement.setZero(m);
  model.area.setOnes(m);
  model.bodies.resize(rods.size());
  for (Index k = 0; k < count; ++k) {
    const auto& [length, speed] = rods[static_cast<std::size_t>(k)];
    const Index first = k * (N + 1);
    model.v0(first) = speed * std::sqrt(length);
    Vector right(m), left(m);  // 1 where the end of this rod takes part, and with which sign
    for (Index i = 0; i < m; ++i) {
      const Meeting& at = meetings[static_cast<std::size_t>(i)];
      right(i) = at.a == k && at.side > 0 ? 1 : 0;
      left(i) = at.b == k || (at.a == k && at.side < 0) ? -1 : 0;
    }
    model.B.col(first) = (right + left) / std::sqrt(length);
    double same = pi * pi / 6, opposite = -pi * pi / 12;  // Σ 1/n², Σ (−1)ⁿ/n²
    for (Index n = 1; n <= N; ++n) {
      const double sign = n % 2 == 0 ? 1 : -1;
      model.omega(first + n) = static_cast<double>(n) * pi / length;
      model.B.col(first + n) = std::sqrt(2 / length) * (sign * right + left);
      same -= 1 / static_cast<double>(n * n);
      opposite -= sign / static_cast<double>(n * n);
    }
    model.R += 2 * length / (pi * pi) *
               (same * (right * right.transpose() + left * left.transpose()) +
                opposite * (right * left.transpose() + left * right.transpose()));
  }
  for (Index i = 0; i < m; ++i) {
    const Meeting& at = meetings[static_cast<std::size_t>(i)];
    model.gap(i) = at.gap;
    Model::PairBlock& pair = model.pairs.emplace_back();
    pair.first_point = static_cast<int>(i);
    pair.points = 1;
    pair.a = at.a;
    pair.b = at.b;
  }
  return model;
}

double speed_of(const Stepper& stepper, Index rod, double length, Index N = 90) {
  return stepper.modal()->v(rod * (N + 1)) / std::sqrt(length);
}

// Two rods hit the same wall; the long one still lies against it when the short one leaves. With one bank for
// both, the short one left with 1.0016 of its speed instead of 0.9996.
TEST(Islands, of_two_rods_at_one_wall_do_not_affect_each_other) {
  for (const int block : {0, 1}) {
    const StepOptions options{.step = 0.1, .block = block};
    const Model both = chain_of({{10, 1}, {40, 1}}, {{0, -1}, {1, -1}}),
                alone = chain_of({{10, 1}}, {{0, -1}});
    const auto beside = make_stepper(both, options), single = make_stepper(alone, options);
    bool both_touch = false;
    for (int k = 0; k < 600; ++k) {
      ASSERT_EQ(beside->step(), StepStatus::ok);
      ASSERT_EQ(single->step(), StepStatus::ok);
      // 1e-8: the step after the one that empties the bank takes up to 1e-9 of its force, by round-off or
      // not.
      ASSERT_NEAR(beside->force()(0), single->force()(0), 1e-8) << k;
      both_touch = both_touch || (beside->force()(0) > 0 && beside->force()(1) > 0);
    }
    EXPECT_TRUE(both_touch);
    EXPECT_NEAR(speed_of(*beside, 0, 10), speed_of(*single, 0, 10),
                5e-12);                                    // of this force: 0.1 N · 1e-9 · Δ/m
    EXPECT_NEAR(speed_of(*single, 0, 10), -0.9996, 1e-4);  // a truncated series keeps a little as vibration
  }
}

// A linking contact closes in a step in which its rods lie against other bodies: their islands are solved
// together. Rods that lie against each other in a row act as one rod, whatever their cuts: the force on the
// wall of a rod of length 30 at speed v is v until t = 60.
TEST(Islands, merge_when_a_point_between_them_closes) {
  const Model cut = chain_of({{10, 1}, {20, 1}}, {{0, 1}, {1, -1}});
  for (const int block : {0, 1}) {
    const auto stepper = make_stepper(cut, {.step = 0.1, .block = block});
    double impulse = 0;
    for (int k = 0; k < 500; ++k) {
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      impulse += stepper->force()(1) * 0.1;
    }
    EXPECT_NEAR(impulse, 50, 0.5);  // 1 %: of the truncated series
    EXPECT_NEAR(speed_of(*stepper, 0, 10) * 10 + speed_of(*stepper, 1, 20) * 20, 30 - impulse, 1e-9);
  }
}

// The second rod meets the first one while this presses against its wall. The forces at the wall then move
// the point between both, which had no force. 1e-12: round-off of displacements of order 1.
TEST(Islands, that_merge_while_one_presses_move_their_points_as_the_modes_do) {
  const Model model = chain_of({{10, -1}, {10, -1}}, {{0, -1, 0, -1}, {0, 1, 5}});
  const auto stepper = make_stepper(model, {.step = 0.1, .block = 1});
  int together = 0;
  for (int k = 0; k < 300; ++k) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    together += stepper->end_force().minCoeff() > 0 ? 1 : 0;
    const Vector u = model.B * stepper->modal()->q - model.R * stepper->end_force();
    ASSERT_LT((stepper->displacement() - u).cwiseAbs().maxCoeff(), 1e-12) << k;
  }
  EXPECT_GT(together, 0);
}

// What a touch has removed is forgotten when it ends: no later one gives it back. Between two walls, a rod
// that vibrates more and more touches about a hundred times. 1e-12: round-off of its energy of 5 J.
TEST(Islands, give_back_in_no_touch_more_than_they_took_in_it) {
  const Model model = chain_of({{10, 1}}, {{0, -1, 3}, {0, -1, 2, -1}});
  for (const int block : {0, 1}) {
    const auto stepper = make_stepper(model, {.step = 0.1, .block = block});
    double at_begin = 0;
    int open = 2, touches = 0;
    for (int k = 0; k < 30'000; ++k) {
      const double before = stepper->modal()->energy().contact;
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      if (stepper->force().maxCoeff() > 0) {
        if (open >= 2) at_begin = before, ++touches;
        open = 0;
      } else {
        ++open;
      }
      ASSERT_GE(stepper->modal()->energy().contact, at_begin - 1e-12) << k;
    }
    EXPECT_GT(touches, 100);
  }
}

// Three rods between two walls meet and part hundreds of times, with steps of a tenth of a wave's crossing.
TEST(Islands, that_merge_and_part_never_gain_energy) {
  const Model model =
      chain_of({{10, 1}, {7, -0.3}, {13, 0}}, {{0, 1, 0.4}, {1, 2, 0.3}, {2, -1, 0.2}, {0, -1, 0.1, -1}}, 30);
  const double initial = 0.5 * model.v0.squaredNorm();
  for (const int block : {0, 1})
    for (const double step : {0.05, 0.3, 1.0}) {
      const auto stepper = make_stepper(model, {.step = step, .block = block});
      int changes = 0, touching = 0;
      double most = 0;
      for (int k = 0; k < 20000; ++k) {
        ASSERT_EQ(stepper->step(), StepStatus::ok);
        changes += stepper->active() != touching;
        touching = stepper->active();
        const Energy& energy = stepper->modal()->energy();
        most = std::max(most, energy.kinetic + energy.strain + energy.residual);
      }
      EXPECT_GT(changes, 300) << step;
      EXPECT_LE(most, initial * (1 + 1e-12)) << step;
      EXPECT_GT(most, 0.5 * initial) << step;
    }
}

// A contact that opens puts in energy with the weight of its last force, and its own part of the bank is
// empty. The other contact of its island pays, so that no part is negative when the island splits.
TEST(Islands, share_their_banks) {
  const Model model = chain_of({{10, 0}, {7, 0}}, {{0, 1}, {1, -1}});
  const StepOptions options{.step = 0.3, .block = 1};
  const RowMatrices matrices(*make_step_system(borrowed(model), options));
  ContactLaw law(model, options);
  MeanForce mean(model, true);
  const Vector force{{0.1, 0.1}};
  mean.advance(force, {{.bank = 0}, {.bank = 1}});
  mean.advance(force, {{.bank = 0}, {.bank = 1}});
  law.start = Vector{{0, 0}};
  law.free = Vector{{-0.5, 1e-3}};
  const StepTrial trial = law.solve(matrices.all(), mean, nullptr);
  ASSERT_EQ(trial.status, SolveStatus::solved);
  ASSERT_EQ(law.force()(0), 0.25 * 0.1 + 0.125 * 0.1);  // of the mean with λ⁺ = 0: it opened
  law.accept(mean, law.end());
  const double first = mean.pairs()[0].bank, second = mean.pairs()[1].bank;
  EXPECT_GE(first, 0);
  EXPECT_LT(second, 1);
  EXPECT_NEAR(first + second, 1 + trial.removed, 1e-15);
}

// A mass of 1 kg under 10 N that slides on one point: friction removes its motion as heat, and contact
// nothing.
TEST(Islands, give_no_credit_for_the_heat_of_friction) {
  Model model;
  model.omega = model.decay = model.load = model.q0 = model.v0 = Vector::Zero(3);
  model.load(0) = 10;
  model.v0(1) = 1;
  model.B = Matrix::Identity(3, 3);
  model.R = 1e-6 * Matrix::Identity(3, 3);
  model.has_residual = true;
  model.gap = model.area = Vector::Zero(1);
  model.static_displacement = Vector::Zero(3);
  model.friction.push_back({.point = 0, .tangential = 1, .law = {0.3, 0.3, 1}});
  const StepOptions options{.step = 1e-3, .block = 1};
  ContactLaw law(model, options);
  MeanForce mean(model, true);
  Slip slip(1, 3, options.step);
  const double c = 0.5 * options.step * options.step;  // of a rigid mode
  const Eigen::MatrixXd M = c * Eigen::MatrixXd::Identity(3, 3), R = model.R, S = M + R,
                        S_mean = conserving_mean.end * M + R;
  Vector q = Vector::Zero(3), v = model.v0, u = q;
  double heat = 0;
  for (int k = 0; k < 200; ++k) {
    law.free = q + options.step * v + c * model.load;
    law.start = u;
    const StepTrial trial = law.solve({.R = R, .S = S, .S_mean = S_mean}, mean, &slip);
    ASSERT_EQ(trial.status, SolveStatus::solved);
    const Vector force = law.force();
    q += options.step * v + c * (model.load - force);
    v += options.step * (model.load - force);
    u = law.u();
    heat += trial.heat;
    law.accept(mean, law.end());
    slip.accept();
  }
  EXPECT_GT(heat, 0.4);  // of 0.5 J
  EXPECT_NEAR(heat, 0.5 * (1 - v(1) * v(1)), 1e-3);
  EXPECT_GE(mean.pairs()[0].bank, 0);
  EXPECT_LT(mean.pairs()[0].bank, 1e-3 * heat);
}

}  // namespace islands_test
