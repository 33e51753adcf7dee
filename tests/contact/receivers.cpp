// SPDX-License-Identifier: BSD-2-Clause
// Motion of receivers and reactions of supports, for bars with known waves and statics.
#include "contact/figures/receivers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/hdf5_reader.hpp"
#include "contact/files/recorder.hpp"
#include "tests/contact/bodies.hpp"

namespace receivers_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;
using ricochet::base::hdf5::Reader;
using ricochet::test::Folder;

constexpr double length = 10;

Kernel damped_bar(int modes, double decay) {
  Kernel bar = clamped_bar(modes, length);
  bar.modes.decay_rate.assign(static_cast<std::size_t>(modes), decay);
  return bar;
}

/// The bar along y, with its tip `gap` below a wall.
Model upright(const Kernel& bar, double gap, const std::vector<ForcingRequest>& forcing, double gravity = 0) {
  return build_model({{"bar", &bar, turn(std::numbers::pi / 2, {0, 0, 1})}},
                     {{"wall", Vector3d(0, length + gap, 0), Vector3d(0, -1, 0)}},
                     {{"bar", "wall", {}, {}, 20 * length}}, {0, gravity, 0}, forcing);
}

ForcingRequest foot(double travel, const History& history) {
  return {"bar", "foot", true, {0, travel, 0}, history};
}
ForcingRequest tip(double force, const History& history) {
  return {"bar", "tip", false, {0, force, 0}, history};
}

// The foot starts to move at speed V: u = V Σ (−1)^j [(t − x − 2jL)₊ + (t − 2L + x − 2jL)₊]. The tolerance
// 3e-3 V L covers fronts that are blurred by modal truncation.
TEST(Receiver, of_a_bar_whose_foot_moves_sees_the_waves_pass) {
  const Kernel bar = clamped_bar(200, length);
  const double speed = 0.3, step = 0.07, x = length / 2;
  const StepOptions options{.contact = {.scheme = Scheme::impulse}, .step = step};
  const Model model = upright(bar, 100, {foot(speed, {{0, 1000}, {0, 1000}})});
  const auto stepper = make_stepper(model, options);
  Receivers receivers(model, options);
  EXPECT_NEAR(receivers[0].velocity.norm(), 0, 3e-3 * speed);
  for (int k = 1; k <= 1000; ++k) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    receivers.observe(*stepper);
    const double t = stepper->time();
    double u = 0, rate = 0, nearest = 1e9;
    for (int j = 0; 2 * j * length < t; ++j)
      for (const double front : {x + 2 * j * length, 2 * length - x + 2 * j * length}) {
        u += (j % 2 == 0 ? speed : -speed) * std::max(0.0, t - front);
        rate += t > front ? (j % 2 == 0 ? speed : -speed) : 0;
        nearest = std::min(nearest, std::abs(t - front));
      }
    EXPECT_NEAR(receivers[0].displacement.y(), u, 3e-3 * speed * length) << t;
    if (nearest > 1) {
      EXPECT_NEAR(receivers[0].velocity.y(), rate, 0.15 * speed) << t;
    }
    EXPECT_NEAR(receivers[0].displacement.x(), 0, 1e-12);
  }
}

// Static equilibrium under weight, load, displaced foot and wall at once. It does not depend on which modes
// are stepped and which are static.
TEST(Receiver, sees_the_static_displacement_of_all_forces_and_supports) {
  const double weight = 1e-3, force = 4e-3, travel = 0.02, gap = 0.05, x = length / 2;
  const double pressed = (travel + weight * length * length / 2 + force * length - gap) / length;
  ASSERT_GT(pressed, 0);
  const double expected = travel + weight * x * (2 * length - x) / 2 + (force - pressed) * x;
  for (const double step : {0.1, 5.0}) {
    const Kernel bar = damped_bar(20, 0.3);
    const Model model =
        upright(bar, gap, {tip(force, {{0, 7.3}, {0, 1}}), foot(travel, {{2, 11}, {0, 1}})}, weight);
    const StepOptions options{.contact = {.scheme = Scheme::compliant}, .step = step};
    const auto folded = fold(borrowed(model), options);
    const auto stepper = make_stepper(folded, options);
    Receivers receivers(*folded, options);
    while (stepper->time() < 600) {
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      receivers.observe(*stepper);
    }
    EXPECT_EQ(stepper->modal()->modes_in_residual() > 0, step > 1);
    EXPECT_NEAR(stepper->force()(0), pressed, 1e-9);
    EXPECT_NEAR(receivers[0].displacement.y(), expected, 1e-9) << step;
    EXPECT_NEAR(receivers[0].velocity.norm(), 0, 1e-9);
    EXPECT_NEAR(receivers[0].acceleration.norm(), 0, 1e-9);
  }
}

// Rates are compared with central differences between knots, with an error of (ωΔ)²/6 = 2e-5 of the
// contribution of the highest mode.
TEST(Receiver, has_velocity_and_acceleration_that_are_the_rates_of_its_displacement) {
  const Kernel bar = damped_bar(3, 0.02);
  const double step = 0.01;
  const StepOptions options{.step = step};
  const Model model =
      upright(bar, 100, {tip(0.4, {{0, 3, 9}, {0, 1, -1}}), foot(0.3, {{0, 5, 20}, {0, 1, 0}})}, 0.1);
  const auto stepper = make_stepper(model, options);
  Receivers receivers(model, options);
  std::vector<ReceiverMotion> seen{receivers[0]};
  for (int k = 0; k < 3000; ++k) {
    ASSERT_EQ(stepper->step(), StepStatus::ok);
    receivers.observe(*stepper);
    seen.push_back(receivers[0]);
  }
  for (std::size_t k = 1; k + 1 < seen.size(); ++k) {
    if (std::ranges::any_of(std::array{300, 500, 900, 2000},
                            [&](int knot) { return std::abs(static_cast<int>(k) - knot) < 2; }))
      continue;
    const Vector3d v = (seen[k + 1].displacement - seen[k - 1].displacement) / (2 * step);
    const Vector3d a = (seen[k + 1].velocity - seen[k - 1].velocity) / (2 * step);
    ASSERT_LT((seen[k].velocity - v).norm(), 1e-4) << k;
    ASSERT_LT((seen[k].acceleration - a).norm(), 1e-4) << k;
  }
}

std::vector<double> run(const Model& model, const StepOptions& options, int steps, int every,
                        const Folder& folder, const std::string& dataset) {
  Recorder recorder(model, options, {.path = folder / "bar.result.h5", .every = every});
  const auto stepper = make_stepper(model, options);
  for (int k = 0; k < steps; ++k) {
    EXPECT_EQ(stepper->step(), StepStatus::ok);
    recorder.record(*stepper);
  }
  recorder.commit();
  return Reader(folder / "bar.result.h5", "").read<double>(dataset, {ricochet::base::hdf5::any, 3});
}

TEST(Result, holds_receivers_at_every_step_whatever_rows_are_written) {
  const Folder folder;
  const Kernel bar = damped_bar(5, 0.1);
  const Model model = upright(bar, 100, {tip(0.4, {{0, 3}, {0, 1}})});
  const auto rows = run(model, {.step = 0.1}, 40, 7, folder, "/receivers/mic/velocity");
  const Reader file(folder / "bar.result.h5", "");
  ASSERT_EQ(rows.size(), 3U * 41);
  EXPECT_EQ(file.string_attribute("/receivers/mic/displacement", "unit"), "m");
  EXPECT_EQ(file.string_attribute("/receivers/mic/acceleration", "unit"), "m/s^2");
  EXPECT_EQ(file.string_attribute("/receivers/mic", "body"), "bar");
  EXPECT_NEAR(file.doubles_attribute("/receivers/mic", "point", 3)[1], length / 2, 1e-15);
  EXPECT_NEAR(file.read<double>("/receivers/time", {41})[40], 4, 1e-12);
  EXPECT_EQ(file.shape("/time")[0], 6U);
  EXPECT_GT(rows.back() * rows.back() + rows[121] * rows[121], 0);
}

// At rest, the support of a hanging bar carries the weight and the load at the tip. If
// there is a wall, its force is subtracted.
TEST(Reaction, of_a_hanging_bar_is_its_weight_and_its_load_less_what_a_wall_carries) {
  for (const double gap : {50.0, 0.01})
    for (const int every : {1, 13}) {
      const Folder folder;
      const Kernel bar = damped_bar(20, 0.3);
      const double weight = 1e-3, force = 4e-3;
      const Model model = upright(bar, gap, {tip(force, {{0.33, 7.77}, {0, 1}})}, weight);
      const auto reaction = run(model, {.step = 0.1}, 7800, every, folder, "/bodies/bar/reaction");
      const double wall = std::max(0.0, (weight * length * length / 2 + force * length - gap) / length);
      EXPECT_NEAR(reaction[reaction.size() - 2], -(weight * length + force - wall), 1e-9)
          << gap << " " << every;
    }
}

// The bar accelerates from rest to the speed V of its foot. The impulse of the
// reaction is m V, regardless of vibrations.
TEST(Reaction, of_a_foot_that_moves_gives_the_bar_its_momentum) {
  for (const int modes : {2, 20}) {
    const Folder folder;
    const Kernel bar = damped_bar(modes, 0.3);
    const double speed = 0.02, step = 0.1;
    const Model model = upright(bar, 100, {foot(speed, {{1.03, 1001.03}, {0, 1000}})});
    const auto reaction = run(model, {.step = step}, 6000, 1, folder, "/bodies/bar/reaction");
    double impulse = 0;
    for (std::size_t k = 1; k < reaction.size(); k += 3) impulse += reaction[k] * step;
    EXPECT_NEAR(impulse, length * speed, 1e-9) << modes;
    const auto velocity =
        Reader(folder / "bar.result.h5", "").read<double>("/bodies/bar/velocity", {6001, 3});
    EXPECT_NEAR(velocity[velocity.size() - 2], speed, 1e-9);
  }
}

// Modes up to 0.13 Hz, rows at 2 Hz. 33 rows from the ends, only the ripple of the filter remains.
TEST(Receiver, in_a_result_with_fewer_rows_keeps_its_motion) {
  const Kernel bar = damped_bar(3, 0.01);
  const Model model = upright(bar, 100, {tip(0.1, {{0, 1e3}, {1, 1}})}, -1e-3);
  const StepOptions options{.step = 0.025, .steps_per_sample = 2};
  constexpr int every = 10, samples = 1009;
  constexpr std::size_t rows = samples / every + 1;
  const auto displacement = [&](int receivers_every, std::size_t count) {
    const Folder folder;
    Recorder recorder(model, options, {.path = folder / "bar.result.h5", .receivers_every = receivers_every});
    const auto stepper = make_stepper(model, options);
    while (stepper->steps() < 2 * samples) {
      EXPECT_EQ(stepper->step(), StepStatus::ok);
      recorder.record(*stepper);
    }
    recorder.commit();
    const Reader file(folder / "bar.result.h5", "");
    const auto time = file.read<double>("/receivers/time", {count});
    for (std::size_t k = 0; k < count; ++k)
      EXPECT_DOUBLE_EQ(time[k], 0.05 * static_cast<double>(k) * receivers_every);
    std::vector<double> out;
    for (const char* name : {"displacement", "velocity", "acceleration"}) {
      const auto values = file.read<double>("/receivers/" + model.receivers[0].name + "/" + name, {count, 3});
      for (std::size_t k = 0; k < count; ++k) out.push_back(values[3 * k + 1]);
    }
    return out;
  };
  const auto all = displacement(1, samples + 1), few = displacement(every, rows);
  double largest = 0, worst = 0;
  for (std::size_t part = 0; part < 3; ++part)
    for (std::size_t k = 33; k + 34 < rows; ++k) {
      const double expected = all[part * (samples + 1) + every * k];
      largest = std::max(largest, std::abs(expected));
      worst = std::max(worst, std::abs(few[part * rows + k] - expected));
    }
  EXPECT_GT(largest, 0.1);
  EXPECT_LT(worst, 2e-5 * largest);
}

}  // namespace receivers_test
