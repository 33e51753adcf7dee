// SPDX-License-Identifier: BSD-2-Clause
// Fewer rows of a signal: tones that must stay, tones that must vanish, and lines that must not bend.
#include "contact/files/decimator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace decimator_test {

using ricochet::contact::Decimator;

struct Output {
  std::vector<std::int64_t> row;
  std::vector<std::vector<double>> values;
};

/// Feeds `rows` rows of signal(row) through the decimator.
template <class Signal>
Output decimated(int every, const std::vector<double>& slope, std::int64_t rows, const Signal& signal) {
  Output out;
  const Decimator::Take take = [&](std::int64_t row, std::span<const double> values) {
    out.row.push_back(row);
    out.values.emplace_back(values.begin(), values.end());
  };
  Decimator decimator(every, slope);
  for (std::int64_t k = 0; k < rows; ++k) decimator.push(signal(k), take);
  decimator.finish(take);
  return out;
}

/// Largest deviation of a decimated sine of `cycles` per output row from `gain` times itself, away from the
/// ends.
double error_of_tone(int every, double cycles, double gain) {
  const auto tone = [&](std::int64_t k) {
    return std::vector{std::sin(2 * std::numbers::pi * cycles * static_cast<double>(k) / every + 0.3)};
  };
  const Output out = decimated(every, {0}, 200 * every, tone);
  EXPECT_EQ(out.row.size(), 200U);
  double worst = 0;
  for (std::size_t k = 40; k < 160; ++k)
    worst = std::max(worst, std::abs(out.values[k][0] - gain * tone(out.row[k])[0]));
  return worst;
}

// 100 dB: 1e-5 of the amplitude.
TEST(Decimator, keeps_tones_below_and_removes_tones_above_the_transition) {
  for (const int every : {2, 8, 25}) {
    for (const double cycles : {0.001, 0.1, 0.3, 0.45})
      EXPECT_LT(error_of_tone(every, cycles, 1), 1.5e-5) << cycles;
    for (const double cycles : {0.55, 0.7, 0.95})
      EXPECT_LT(error_of_tone(every, cycles, 0), 1.5e-5) << cycles;
    // In the middle of the transition, the filter passes half.
    EXPECT_LT(error_of_tone(every, 0.5, 0.5), 1e-3);
  }
}

TEST(Decimator, keeps_each_row_if_none_is_left_out) {
  const auto signal = [](std::int64_t k) { return std::vector{0.1 * k * k, std::cos(2.5 * k)}; };
  const Output out = decimated(1, {3, 4}, 20, signal);
  ASSERT_EQ(out.row.size(), 20U);
  for (std::int64_t k = 0; k < 20; ++k) {
    EXPECT_EQ(out.row[k], k);
    EXPECT_EQ(out.values[k], signal(k));
  }
}

// Runs that are shorter than the filter, too. The last row is the last whole multiple.
TEST(Decimator, leaves_lines_straight_up_to_both_ends) {
  for (const std::int64_t rows : {1, 2, 7, 100, 2000}) {
    const auto lines = [](std::int64_t k) { return std::vector{5 - 0.25 * static_cast<double>(k), 7.0}; };
    const Output out = decimated(6, {-0.25, 0}, rows, lines);
    ASSERT_EQ(out.row.size(), static_cast<std::size_t>((rows + 5) / 6));
    for (std::size_t k = 0; k < out.row.size(); ++k) {
      EXPECT_EQ(out.row[k], static_cast<std::int64_t>(6 * k));
      EXPECT_NEAR(out.values[k][0], lines(out.row[k])[0], 1e-11 * static_cast<double>(rows));
      EXPECT_NEAR(out.values[k][1], 7, 1e-12);
    }
  }
}

// The sum of the output times n is the impulse of a blow.
TEST(Decimator, keeps_the_sum_of_a_blow) {
  const auto blow = [](std::int64_t k) { return std::vector{k == 400 ? 1.0 : 0.0}; };
  const Output out = decimated(8, {0}, 4000, blow);
  double sum = 0;
  for (const auto& values : out.values) sum += 8 * values[0];
  EXPECT_NEAR(sum, 1, 3e-5);  // images of the row rate
}

}  // namespace decimator_test
