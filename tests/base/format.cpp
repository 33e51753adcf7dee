// SPDX-License-Identifier: BSD-2-Clause
#include "base/format.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace ricochet::base {
namespace format_test {

// The fmt library, which the programs use, is the reference.
TEST(Format, prints_numbers_as_fmt_does) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> exponent(-30, 30), mantissa(-10, 10);
  for (int k = 0; k < 20000; ++k) {
    const double x =
        mantissa(random) * std::pow(10, k % 2 == 0 ? exponent(random) : std::floor(exponent(random)));
    ASSERT_EQ(format("{} m", x), fmt::format("{} m", x));
    ASSERT_EQ(format("{:.6g}", x), fmt::format("{:.6g}", x));
    ASSERT_EQ(format("{:.3g}", x), fmt::format("{:.3g}", x));
  }
  for (const double x : {0.0, -0.0, 1.0, 1e-4, 9.9e-5, 1e15, 1e16, 100000.0, 0.1,
                         std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
    EXPECT_EQ(format("{}", x), fmt::format("{}", x));
}

TEST(Format, puts_arguments_in_their_order) {
  const std::string name = "floor";
  EXPECT_EQ(format("bodies.{}: {} of {}, \"{}\"", name, 3, std::size_t{7}, "x"),
            "bodies.floor: 3 of 7, \"x\"");
  EXPECT_EQ(format("no argument"), "no argument");
}

}  // namespace format_test
}  // namespace ricochet::base
