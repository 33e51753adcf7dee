// SPDX-License-Identifier: BSD-2-Clause
// The filter and the fade of sounds for players.
#include "src/sound/shaping.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shaping_test {

using ricochet::sound::fade_out;
using ricochet::sound::high_pass;

constexpr double rate = 44100;

/// Gain of the filter at a frequency, from the second half of one second.
double gain(double corner, double hertz) {
  std::vector<float> tone;
  for (int k = 0; k < rate; ++k)
    tone.push_back(static_cast<float>(std::sin(2 * std::numbers::pi * hertz * k / rate)));
  high_pass(tone, 1, corner, rate);
  double largest = 0;
  for (std::size_t k = tone.size() / 2; k < tone.size(); ++k)
    largest = std::max(largest, std::abs(static_cast<double>(tone[k])));
  return largest;
}

// Butterworth's analogue prototype, 1/√(1 + (f_c/f)^8). The transient has decayed to 1e-3 and less.
TEST(HighPass, has_the_gain_of_a_butterworth_filter_of_fourth_order) {
  for (const double corner : {20.0, 100.0})
    for (const double ratio : {0.5, 1.0, 1.2, 2.0, 10.0})
      EXPECT_NEAR(gain(corner, ratio * corner), 1 / std::sqrt(1 + std::pow(ratio, -8)), 2e-3) << ratio;
}

// A body at constant velocity from the first frame on, and one that a blow sets in motion at frame 1000.
TEST(HighPass, silences_rigid_motion_from_the_start) {
  std::vector<float> sound;
  for (int k = 0; k < rate; ++k) sound.insert(sound.end(), {0.7F, k < 1000 ? 0.0F : 1.0F});
  high_pass(sound, 2, 20, rate);
  for (std::size_t k = 0; k < sound.size(); k += 2) EXPECT_EQ(sound[k], 0);
  EXPECT_NEAR(sound[2001], 1, 0.01);  // the blow itself is heard
  EXPECT_LT(std::abs(sound.back()), 1e-6);
}

TEST(FadeOut, ends_at_zero_and_leaves_the_rest) {
  std::vector<float> sound(2 * 1001, 1.0F);
  fade_out(sound, 2, 500);
  for (std::size_t k = 0; k <= 1000; ++k) EXPECT_EQ(sound[k], 1) << k;
  EXPECT_NEAR(sound[2 * 750], 0.5, 1e-6);
  EXPECT_EQ(sound[2 * 1000], 0);
  EXPECT_EQ(sound[2 * 1000 + 1], 0);
  EXPECT_TRUE(std::ranges::is_sorted(sound, std::ranges::greater{}));
  std::vector<float> whole(100, 1.0F), unchanged = whole, empty;
  fade_out(whole, 1, 1e9);
  EXPECT_EQ(whole.front(), 1);
  EXPECT_EQ(whole.back(), 0);
  fade_out(unchanged, 1, 0);
  EXPECT_EQ(unchanged, std::vector<float>(100, 1.0F));
  fade_out(empty, 1, 5);
}

}  // namespace shaping_test
