// SPDX-License-Identifier: BSD-2-Clause
// Extreme settings of stepping: step length, damping, masses, precision, and numbers of steps. Each is
// compared with a closed form or a conservation law. scripts/verify --extremes prints the results as a table.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "contact/stepping/stepper.hpp"
#include "tests/contact/bodies.hpp"

namespace extremes_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;

/// A line of the table: setting, oracle, bound on the error, and largest error.
class Row {
 public:
  Row(const std::string& setting, const std::string& oracle, double bound)
      : setting_(setting), oracle_(oracle), bound_(bound) {}
  Row(const Row&) = delete;
  Row& operator=(const Row&) = delete;
  ~Row() {
    EXPECT_LE(worst_, bound_) << setting_;
    const int number = rows_++;
    const auto keep = [&](const char* what, const std::string& value) {
      testing::Test::RecordProperty(fmt::format("row_{}_{}", number, what), value);
    };
    keep("setting", setting_);
    keep("oracle", oracle_);
    keep("bound", fmt::format("{}", bound_));
    keep("found", fmt::format("{}", worst_));
  }

  /// Records the error relative to `scale`. A NaN is kept.
  void error(double found, double expected, double scale) {
    const double e = std::abs(found - expected) / scale;
    if (!(e <= worst_)) worst_ = e;
  }
  void relative(double found, double expected) { error(found, expected, std::abs(expected)); }

 private:
  std::string setting_, oracle_;
  double bound_, worst_ = 0;
  static inline int rows_ = 0;
};

constexpr double length = 10;  // rods with c = ρA = EA = 1: mass 10, highest mode nπ/L

/// A rod that moves right towards a wall; with gap 0 it touches the wall at the start.
Model against_wall(const Kernel& kernel, double gap = 0, double speed = 1) {
  return build_model({{"rod", &kernel, Matrix3d::Identity(), Vector3d::Zero(), {speed, 0, 0}}},
                     {{"wall", {length + gap, 0, 0}, {-1, 0, 0}}}, {{"rod", "wall", {}, {}, {}}},
                     Vector3d::Zero());
}

double shortest_period(const Model& model) { return 2 * std::numbers::pi / model.omega.maxCoeff(); }

struct Impact {
  double impulse = 0, velocity = 0;  ///< Σ λΔ; mean velocity at the end
  double drift = 0;                  ///< deviation of the ledger, relative
  double gain = 0;                   ///< largest energy that contact has put in so far, relative
  bool ok = true;
};

Impact collide(const Model& model, const StepOptions& options, int steps) {
  const auto stepper = make_stepper(model, options);
  const double initial = stepper->modal()->energy().ledger();
  Impact out;
  for (int k = 0; k < steps && out.ok; ++k) {
    out.ok = stepper->step() == StepStatus::ok;
    out.impulse += options.step * stepper->force().sum();
    out.gain = std::max(out.gain, -stepper->modal()->energy().contact / initial);
    out.drift = std::max(out.drift, std::abs(stepper->modal()->energy().ledger() / initial - 1));
  }
  out.velocity = model.momentum(0, stepper->modal()->v, stepper->time()).x() / model.bodies[0].mass;
  return out;
}

/// Checks momentum, ledger and energy gain, whatever the course of the impact.
void expect_balance(const Model& model, const StepOptions& options, int steps, Row& row) {
  const Impact impact = collide(model, options, steps);
  const double mass = model.bodies[0].mass;
  EXPECT_TRUE(impact.ok);
  row.error(impact.impulse, mass * (1 - impact.velocity), mass);
  row.error(impact.drift, 0, 1);
  row.error(impact.gain, 0, 1);
}

TEST(ExtremeStep, of_any_length_keeps_momentum_and_ledger_and_gains_no_energy) {
  const Kernel kernel = rod(40, length);
  const Model model = against_wall(kernel);
  // 1e-10: round-off of 2000 steps, where R stores up to 1e5 times the kinetic energy
  Row row("Δ = 1e-12 to 1e4 shortest periods", "momentum, ledger, contact gives no energy", 1e-10);
  for (int k = -12; k <= 4; ++k)
    expect_balance(model, {.step = std::pow(10.0, k) * shortest_period(model)}, 2000, row);
}

// As long as waves are negligible, the modes do not move: λ = v t/R.
TEST(ExtremeStep, far_below_the_periods_loads_the_residual_spring) {
  const Kernel kernel = rod(40, length);
  const Model model = against_wall(kernel);
  for (const double share : {1e-12, 1e-10, 1e-8}) {
    const double step = share * shortest_period(model);
    const auto stepper = make_stepper(model, {.step = step});
    Row row(fmt::format("Δ = {:g} shortest periods, 100 steps", share), "λ = v t/R", 1e-6);
    for (int k = 1; k <= 100; ++k) {
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      row.relative(stepper->end_force()(0), k * step / model.R(0, 0));
    }
  }
}

// All modes are quasi-static: a mass m on the static flexibility F = L/(3EA), S = Δ²/2m + F,
// λ = vΔ/S. The rod is free in the next step.
TEST(ExtremeStep, far_above_the_periods_turns_a_rigid_body_round) {
  const Kernel kernel = rod(40, length);
  const Model model = against_wall(kernel);
  for (const double periods : {1e3, 1e4}) {
    const double step = periods * shortest_period(model);
    const Impact impact = collide(model, {.step = step}, 2);
    const double force = step / (step * step / (2 * length) + length / 3);
    // F is the sum over a million modes, which lacks 1e-6 of the exact value
    Row row(fmt::format("Δ = {:g} shortest periods", periods), "rigid body on its static flexibility", 1e-6);
    row.relative(impact.velocity, 1 - force * step / length);
    row.error(impact.drift, 0, 1e-6);
  }
}

TEST(ExtremeDamping, from_none_to_a_hundredfold_of_critical_keeps_momentum_and_ledger) {
  for (const double ratio : {0.0, 1e-6, 0.999999, 1.0, 1.000001, 100.0}) {
    Kernel kernel = rod(40, length);
    for (std::size_t n = 0; n < kernel.modes.size(); ++n)
      kernel.modes.decay_rate[n] = ratio * kernel.modes.angular_frequency[n];
    Row row(fmt::format("ζ = {}, impact of a rod", ratio), "momentum, ledger, contact gives no energy",
            1e-11);
    expect_balance(against_wall(kernel), {.step = 0.01}, 3000, row);
  }
}

// A change of units is equivalent to bodies of another mass, stiffness and size. Single precision represents
// numbers from 1e-38 to 1e38, and squares only of numbers up to 1e19.
TEST(ExtremeSinglePrecision, follows_double_in_any_units) {
  const Kernel unit = rod(40, length);
  for (const auto& [mass, time] :
       {std::pair(1.0, 1.0), std::pair(1e-12, 1e-9), std::pair(1e12, 1e3), std::pair(1e-21, 1e-12)}) {
    // Lengths are unchanged; frequencies scale by 1/time, modes by mass^-1/2, R by time²/mass.
    Kernel kernel = unit;
    kernel.mass *= mass;
    for (double& x : kernel.inertia) x *= mass;
    for (double& x : kernel.modes.angular_frequency) x /= time;
    for (double& x : kernel.surface.shape) x /= std::sqrt(mass);
    for (double& x : kernel.loads.body_force) x *= std::sqrt(mass);
    for (double& x : kernel.surface.residual_flexibility) x *= time * time / mass;
    const Model model = against_wall(kernel, 0.05, 1 / time), reference = against_wall(unit, 0.05);
    const auto found =
        make_stepper(model, {.step = 0.01 * time, .block = 16, .precision = Precision::float32});
    const auto expected = make_stepper(reference, {.step = 0.01});
    // 1e-4: 24 bits over the 16 steps of a block, for a force that is an amplified difference
    Row row(fmt::format("single precision, masses times {:g}, times times {:g}", mass, time),
            "double precision in other units", 1e-4);
    double impulse = 0, same = 0;
    for (int k = 0; k < 2400; ++k) {
      ASSERT_EQ(found->step(), StepStatus::ok);
      ASSERT_EQ(expected->step(), StepStatus::ok);
      impulse += found->force().sum() * 0.01 * time / mass * time;
      same += expected->force().sum() * 0.01;
      if (k % 100 == 99) row.error(impulse, same, 2 * length);
    }
  }
}

// A mode that is released oscillates forever: q = (f/ω²)(1 − cos ωt).
TEST(ExtremeTenMillionSteps, of_free_motion_keep_phase_and_energy) {
  Kernel kernel = clamped_bar(4, length);
  Model model = build_model({{"bar", &kernel}}, {{"wall", {2 * length, 0, 0}, {-1, 0, 0}}},
                            {{"bar", "wall", {}, {}, {}}}, {0.01, 0, 0});
  model.q0.setZero();          // released from the shape without loads, so that it moves
  const double step = 0.0123;  // no fraction of a period, 4L/(2n + 1)
  const auto stepper = make_stepper(model, {.step = step});
  constexpr std::int64_t steps = 10'000'000;
  for (std::int64_t k = 0; k < steps; ++k) ASSERT_EQ(stepper->step(), StepStatus::ok);
  // Each step may turn a mode by a rounding error of 1e-16 of its state:
  // 1e-9 in total if all have the same sign.
  Row row("1e7 steps of free motion under gravity", "q = f (1 − cos ωt)/ω²", 1e-8);
  for (Eigen::Index n = 0; n < model.omega.size(); ++n) {
    const double rest = model.load(n) / (model.omega(n) * model.omega(n));
    row.error(stepper->modal()->q(n),
              rest * (1 - std::cos(model.omega(n) * static_cast<double>(steps) * step)), std::abs(rest));
  }
  row.error(stepper->modal()->energy().ledger(), 0,
            (model.load.array() / model.omega.array()).square().sum());
}

// The damped rod comes to rest in its static equilibrium.
TEST(ExtremeMillionSteps, at_rest_under_gravity_carry_the_weight_without_sinking) {
  Kernel kernel = rod(20, length);
  for (std::size_t n = 0; n < kernel.modes.size(); ++n) kernel.modes.decay_rate[n] = 0.05;
  const double weight = 0.01 * length;
  for (const double gap : {0.0, 1e-6}) {
    const Model model = build_model({{"rod", &kernel}}, {{"wall", {length + gap, 0, 0}, {-1, 0, 0}}},
                                    {{"rod", "wall", {}, {}, {}}}, {0.01, 0, 0});
    const auto stepper = make_stepper(model, {.step = 0.01});
    for (int k = 0; k < 1'000'000; ++k) ASSERT_EQ(stepper->step(), StepStatus::ok);
    Row row(fmt::format("1e6 steps under gravity, from a gap of {:g}", gap), "λ = m g; u = gap", 1e-9);
    row.relative(stepper->force()(0), weight);
    row.error(stepper->displacement()(0), gap, 0.1);
    row.error(stepper->modal()->v.norm(), 0, 1);
  }
}

}  // namespace extremes_test
