// SPDX-License-Identifier: BSD-2-Clause
// The flexibility error and the contributions of modes to it, compared with dense complex matrices.
#include <gtest/gtest.h>

#include <numeric>

#include "tests/kernels/dense_band.hpp"
#include "tests/orthonormal.hpp"

namespace ricochet::kernels {
namespace band_test {

using namespace test_band;

/// Magnitude of the subtracted terms relative to ‖H‖, which determines the round-off. If static parts are
/// subtracted, it reaches (band/ω)² of the lowest mode.
double subtracted(const Set& coarse, const Set& fine, bool quasi_static) {
  double most = 0;
  for (const std::complex<double> s : ray()) {
    MatrixXcd a = coarse.flexibility(s), b = fine.flexibility(s);
    const double norm = b.norm();
    if (quasi_static) a -= coarse.flexibility(0);
    if (quasi_static) b -= fine.flexibility(0);
    most = std::max(most, (a.norm() + b.norm()) / norm);
  }
  return most;
}

void expect_dense_error(const Set& coarse, const Set& fine, bool quasi_static) {
  EXPECT_NEAR(flexibility_error(coarse.modes(), fine.modes(), band, quasi_static),
              dense_error(coarse, fine, quasi_static), 1e-13 * subtracted(coarse, fine, quasi_static));
}

void expect_no_error(const Set& coarse, const Set& fine, bool quasi_static) {
  EXPECT_LT(flexibility_error(coarse.modes(), fine.modes(), band, quasi_static),
            1e-13 * subtracted(coarse, fine, quasi_static));
}

Choice some(Random& random, std::size_t n) {
  Choice choice(n);
  for (std::size_t k = 0; k < n; ++k) choice[k] = random() % 3 == 0;
  return choice;
}

Order shuffled(Random& random, std::size_t n) {
  Order order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), random);
  return order;
}

class Flexibility : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(WithAndWithoutItsStaticPart, Flexibility, testing::Bool());

TEST_P(Flexibility, error_is_that_of_dense_matrices) {
  Random random(1);
  for (const Index c : {1, 3, 20}) {
    const Set fine = random_set(random, c, 12), other = random_set(random, c, 7);
    expect_dense_error(other, fine, GetParam());
    for (const double off : {1e-4, 1e-2, 0.3}) {
      const Set coarse = nearly(random, fine, off).of(shuffled(random, 12));
      expect_dense_error(coarse, fine, GetParam());
    }
    for (int k = 0; k < 5; ++k) {
      const Set coarse = fine.of(some(random, 12));
      expect_dense_error(coarse, fine, GetParam());
    }
  }
}

// The ray has no resonances, so few samples suffice: the error rises by at most 2 % between them.
TEST_P(Flexibility, error_is_hardly_larger_between_the_samples) {
  Random random(2);
  for (int k = 0; k < 20; ++k) {
    const Set fine = random_set(random, 3, 30), coarse = fine.of(some(random, 30));
    const double found = flexibility_error(coarse.modes(), fine.modes(), band, GetParam());
    const double everywhere = dense_error(coarse, fine, GetParam(), 2400);
    EXPECT_LE(found, everywhere * (1 + 1e-9));
    EXPECT_GE(found, everywhere * 0.98);
  }
}

// The norm of many candidates is estimated from 64 random combinations.
TEST_P(Flexibility, error_of_many_candidates_is_about_that_of_dense_matrices) {
  Random random(12);
  const Set fine = random_set(random, 150, 30), coarse = nearly(random, fine, 0.03);
  const double exact = dense_error(coarse, fine, GetParam());
  EXPECT_NEAR(flexibility_error(coarse.modes(), fine.modes(), band, GetParam()), exact, 0.3 * exact);
}

TEST_P(Flexibility, error_of_a_set_that_differs_only_in_its_order_is_zero) {
  Random random(3);
  for (const Index c : {1, 3, 20}) {
    const Set set = random_set(random, c, 30);
    EXPECT_LT(flexibility_error(set.modes(), set.modes(), band, GetParam()), 1e-7);
    expect_no_error(set.of(shuffled(random, 30)), set, GetParam());
  }
}

// Only the space of a multiple mode is determined, and each of its bases gives the same H.
TEST_P(Flexibility, error_of_another_basis_of_a_multiple_mode_is_zero) {
  Random random(4);
  Set set = random_set(random, 5, 8);
  set.lambda.head(3).setConstant(std::pow(0.5 * band.value, 2));
  Set turned = set;
  turned.trace.leftCols(3) *= ricochet::test::orthonormal(MatrixXd::Random(3, 3));
  ASSERT_GT((turned.trace - set.trace).norm(), 1);
  expect_no_error(turned, set, GetParam());
}

TEST(Flexibility, error_without_modes_is_1_or_that_beyond_the_static_part) {
  Random random(5);
  const Set fine = random_set(random, 4, 10), none{VectorXd(0), MatrixXd(4, 0)};
  EXPECT_DOUBLE_EQ(flexibility_error(none.modes(), fine.modes(), band, false), 1);
  expect_dense_error(none, fine, true);
}

TEST(Flexibility, error_is_zero_if_the_fine_set_is_empty) {
  Random random(6);
  const Set set = random_set(random, 4, 10), none{VectorXd(0), MatrixXd(4, 0)};
  Set unmoved = set;
  unmoved.trace.setZero();
  EXPECT_EQ(flexibility_error(set.modes(), none.modes(), band, true), 0);
  EXPECT_EQ(flexibility_error(set.modes(), unmoved.modes(), band, true), 0);
}

TEST(Contributions, give_the_error_of_dense_matrices_with_truncated_modes) {
  Random random(7);
  for (const Index c : {1, 3, 20}) {
    const Set set = random_set(random, c, 15);
    const Contributions worth(set.modes(), band);
    for (int k = 0; k < 10; ++k) {
      const Choice left_out = some(random, 15);
      const double expected = dense_error_without(set, left_out);
      EXPECT_NEAR(worth.error_without(left_out), expected, 1e-12 * expected);
    }
    EXPECT_EQ(worth.error_without(Choice(15, false)), 0);
    const double all = dense_error_without(set, Choice(15, true));
    EXPECT_NEAR(worth.error_without(Choice(15, true)), all, 1e-12 * all);
  }
}

TEST(Contributions, ascend_by_the_error_of_truncating_each_mode_alone) {
  Random random(8);
  for (const Index c : {1, 3, 20}) {
    const Set set = random_set(random, c, 40);
    const Order order = Contributions(set.modes(), band).ascending();
    ASSERT_EQ(order.size(), 40U);
    Order sorted = order;
    std::ranges::sort(sorted);
    Order all(40);
    std::iota(all.begin(), all.end(), std::size_t{0});
    ASSERT_EQ(sorted, all);
    double last = 0;
    for (const std::size_t k : order) {
      Choice alone(40, false);
      alone[k] = true;
      const double error = dense_error_without(set, alone);
      EXPECT_GE(error, last * (1 - 1e-12));
      last = error;
    }
  }
}

// An example is a mode of low frequency that contact cannot excite because of symmetry.
TEST(Contributions, of_modes_that_vanish_at_the_contact_surface_are_the_least) {
  Random random(9);
  Set set = random_set(random, 6, 20);
  set.lambda.head(3) *= 1e-4;
  set.trace.leftCols(3).setZero();
  const Contributions worth(set.modes(), band);
  EXPECT_EQ(Order(worth.ascending().begin(), worth.ascending().begin() + 3), (Order{0, 1, 2}));
  EXPECT_EQ(worth.dispensable(worth.ascending(), 0), 3U);
}

TEST(Contributions, dispense_with_as_many_as_a_search_one_by_one) {
  Random random(10);
  const Set set = random_set(random, 3, 16);
  const Contributions worth(set.modes(), band);
  Order few = shuffled(random, 16);
  few.resize(5);
  for (const Order& order : {worth.ascending(), shuffled(random, 16), shuffled(random, 16), few}) {
    Choice left_out(16, false);
    double before = 0;
    for (std::size_t k = 0; k < order.size(); ++k) {
      left_out[order[k]] = true;
      const double error = dense_error_without(set, left_out);
      ASSERT_GT(error, before);
      EXPECT_EQ(worth.dispensable(order, (before + error) / 2), k);
      before = error;
    }
    EXPECT_EQ(worth.dispensable(order, 1.01 * before), order.size());
  }
}

TEST(Contributions, of_no_modes_are_none) {
  const Contributions worth({}, band);
  EXPECT_TRUE(worth.ascending().empty());
  EXPECT_EQ(worth.error_without({}), 0);
  EXPECT_EQ(worth.dispensable({}, 0.1), 0U);
}

}  // namespace band_test
}  // namespace ricochet::kernels
