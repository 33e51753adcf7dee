// SPDX-License-Identifier: BSD-2-Clause
// The share of the modes above the band, compared with the exact modes of rods.
#include "contact/figures/band_share.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "contact/figures/summary_observer.hpp"
#include "tests/contact/bodies.hpp"

namespace band_share_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;

constexpr double length = 10;

/// Energy that a constant force over a time leaves in the elastic modes of a rod with ρcA = 1, from the mode
/// with one number to that with another: Σ ½ (2/L) |F(ω)|², ω = nπ/L, |F(ω)|² = 4 F² sin²(ωT/2)/ω².
double left_in_modes(double of_length, double force, double time, int first, int last) {
  double sum = 0;
  for (int n = first; n <= last; ++n) {
    const double omega = n * std::numbers::pi / of_length;
    sum += 4 * std::pow(force * std::sin(omega * time / 2) / omega, 2) / of_length;
  }
  return sum;
}

// The times are no multiples of the period 2L of the rod, so that sin² takes all values. 25 %: the samples.
TEST(BandShare, of_a_constant_force_is_the_energy_that_it_leaves_in_the_modes_above) {
  for (const int modes : {20, 60})
    for (const double time : {3.7, 12.4, 27.3}) {
      const Kernel kernel = rod(modes + 1, length);
      const Model model = build_model({{.name = "rod", .kernel = &kernel}},
                                      {{.name = "wall", .point = {length, 0, 0}, .normal = {-1, 0, 0}}},
                                      {PairRequest{"rod", "wall", {}, {}, {}}}, {0, 0, 0});
      const double step = length / modes / 16;  // 16 steps in half of the shortest period
      BandShare share(model, step);
      const auto steps = std::llround(time / step);
      for (int k = 1; k <= steps; ++k) share.observe(k * step, Vector::Constant(1, 2.5));
      const double exact =
          left_in_modes(length, 2.5, static_cast<double>(steps) * step, modes + 1, 16 * modes);
      ASSERT_TRUE(share.energy());
      EXPECT_NEAR(*share.energy() / exact, 1, 0.25) << modes << " modes, " << time << " s";
    }
}

// d'Alembert: two rods push each other with Zv/2 for twice the travel time of the shorter one. Its own modes
// return what they took, since the time is their period, but their density does not tell this: the estimate
// counts both rods. A truncated force has ripple at the end of the band besides.
TEST(BandShare, of_colliding_rods_is_up_to_four_times_what_the_modes_above_take) {
  constexpr double shorter = 6.18, speed = 1;
  for (const int modes : {30, 60, 120}) {
    const std::vector<Kernel> rods{rod(modes * shorter / length + 1, shorter), rod(modes + 1, length)};
    const Model model = build_model(
        {{.name = "a", .kernel = rods.data(), .translation = {-shorter, 0, 0}, .velocity = {speed, 0, 0}},
         {.name = "b", .kernel = &rods[1]}},
        {}, {PairRequest{"a", "b", Vector3d(1, 0, 0), {}, {}}}, {0, 0, 0});
    const double step = length / modes / 4;
    const auto stepper = make_stepper(model, {.step = step});
    SummaryObserver observer(model, step, 0);
    while (stepper->time() < 30) {
      ASSERT_EQ(stepper->step(), StepStatus::ok);
      observer.observe(*stepper);
    }
    const Summary found = observer.summary();
    const double exact = left_in_modes(length, speed / 2, 2 * shorter, modes + 1, 4 * modes),
                 before = shorter * speed * speed / 2;
    ASSERT_TRUE(found.energy_above_band);
    EXPECT_GT(*found.energy_above_band * before, exact) << modes;
    EXPECT_LT(*found.energy_above_band * before, 4 * exact) << modes;
    // The relative motion is that of the reduced mass.
    const double reduced = shorter * length / (shorter + length) / 2, e = *found.restitution;
    EXPECT_NEAR(*found.rebound_above_band,
                e - std::sqrt(e * e - *found.energy_above_band * before / (reduced * speed * speed)),
                1e-3 * e);
  }
}

TEST(BandShare, is_unknown_without_elastic_modes_or_steps_that_sample_more_than_the_band) {
  const Kernel rigid = rod(1, length), elastic = rod(20, length);
  for (const auto& [kernel, step] : {std::pair(&rigid, 0.01), std::pair(&elastic, 0.6)}) {
    const Model model = build_model({{.name = "rod", .kernel = kernel}},
                                    {{.name = "wall", .point = {length, 0, 0}, .normal = {-1, 0, 0}}},
                                    {PairRequest{"rod", "wall", {}, {}, {}}}, {0, 0, 0});
    BandShare share(model, step);
    EXPECT_EQ(share.energy(), 0);  // nothing has touched
    for (int k = 1; k <= 10; ++k) share.observe(k * step, Vector::Constant(1, 1));
    EXPECT_FALSE(share.energy()) << step;
  }
}

}  // namespace band_share_test
