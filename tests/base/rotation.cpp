// SPDX-License-Identifier: BSD-2-Clause
#include "base/rotation.hpp"

#include <gtest/gtest.h>

#include <random>

namespace rotation_test {

using namespace ricochet;

/// Angles of one rotation differ, so that the rotations are compared.
void expect_back(const Vector3& degrees) {
  const std::array<double, 9> wanted = rotation_of(degrees), found = rotation_of(degrees_of(wanted));
  for (std::size_t k = 0; k < 9; ++k)
    EXPECT_NEAR(found[k], wanted[k], 1e-14) << degrees[0] << ' ' << degrees[1] << ' ' << degrees[2];
}

TEST(Angles, are_those_of_a_rotation) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> angle(-400, 400);
  for (int k = 0; k < 100; ++k) expect_back({angle(random), angle(random), angle(random)});
}

TEST(Angles, are_found_where_two_axes_coincide) {
  for (const double y : {90.0, -90.0, 90 + 1e-10})
    for (const double x : {0.0, 20.0, -170.0}) expect_back({x, y, 35});
}

}  // namespace rotation_test
