// SPDX-License-Identifier: BSD-2-Clause
// Convolutions compared with the explicit sum, for every way of partitioning them.
#include "contact/table/convolution.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/contact/heap_counter.hpp"

namespace convolution_test {

using namespace ricochet::contact;

struct Case {
  int rows, columns;
  std::int64_t length;
  std::vector<double> response;  ///< (L, rows, columns)
  Eigen::MatrixXd x;             ///< (columns, samples)

  double h(std::int64_t l, int i, int j) const { return response[(l * rows + i) * columns + j]; }

  /// Σ_{l=1}^{L−1} H_l x_{k−l}, from the smallest index on, in extended precision.
  Eigen::VectorXd sum(std::int64_t k) const {
    Eigen::VectorXd out(rows);
    for (int i = 0; i < rows; ++i) {
      long double total = 0;
      for (std::int64_t l = 1; l < length && l <= k; ++l)
        for (int j = 0; j < columns; ++j) total += static_cast<long double>(h(l, i, j)) * x(j, k - l);
      out(i) = static_cast<double>(total);
    }
    return out;
  }
};

/// Contact that comes and goes: each column is nonzero in a fraction `share` of all periods of 40 samples.
Case random_case(int rows, int columns, std::int64_t length, std::int64_t samples, double share,
                 unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0, 1);
  Case out{rows, columns, length, {}, Eigen::MatrixXd::Zero(columns, samples)};
  for (std::int64_t k = 0; k < length * rows * columns; ++k) out.response.push_back(normal(random));
  for (int j = 0; j < columns; ++j) {
    bool on = false;
    for (std::int64_t k = 0; k < samples; ++k) {
      if (k % 40 == 0) on = unit(random) < share;
      if (on) out.x(j, k) = normal(random);
    }
  }
  return out;
}

/// Largest deviation from the explicit sum, relative to ‖H‖ ‖x‖ of a row, which bounds any result.
double error_of(const Case& c, int block) {
  Convolution convolution(c.response, c.rows, c.columns, Tail::none, block);
  double worst = 0;
  for (std::int64_t k = 0; k < c.x.cols(); ++k) {
    worst = std::max(worst, (convolution.history() - c.sum(k)).cwiseAbs().maxCoeff());
    convolution.push(c.x.col(k));
  }
  double size = 0;
  for (const double h : c.response) size += h * h;
  return worst / (std::sqrt(size / c.rows) * c.x.norm());
}

TEST(Convolution, equals_the_sum_directly_and_in_partitions_of_any_size) {
  int seed = 0;
  for (const std::int64_t length : {1, 2, 3, 16, 17, 100, 257})
    for (const auto& [rows, columns] : {std::pair{1, 1}, std::pair{4, 2}, std::pair{3, 3}})
      for (const double share : {1.0, 0.4}) {
        const Case c = random_case(rows, columns, length, 400, share, ++seed);
        for (const int block : {0, 1, 2, 4, 16, 64}) {
          SCOPED_TRACE(testing::Message() << length << " samples in blocks of " << block);
          EXPECT_LT(error_of(c, block), 1e-15);
        }
      }
}

TEST(Convolution, in_partitions_equals_the_direct_one_over_thousands_of_steps) {
  const Case c = random_case(6, 3, 3000, 6000, 0.5, 3);
  Convolution direct(c.response, 6, 3, Tail::none, 1), fast(c.response, 6, 3, Tail::none);
  EXPECT_EQ(direct.block(), 0);
  EXPECT_GE(fast.block(), 64);
  double worst = 0, largest = 0;
  for (std::int64_t k = 0; k < 6000; ++k) {
    worst = std::max(worst, (direct.history() - fast.history()).cwiseAbs().maxCoeff());
    largest = std::max(largest, direct.history().cwiseAbs().maxCoeff());
    direct.push(c.x.col(k));
    fast.push(c.x.col(k));
  }
  EXPECT_LT(worst, 1e-12 * largest);
}

TEST(Convolution, of_nothing_is_exactly_nothing) {
  Case c = random_case(2, 2, 300, 900, 1, 5);
  c.x.rightCols(700).setZero();  // the last input leaves the table after 500 samples
  for (const int block : {1, 16}) {
    Convolution convolution(c.response, 2, 2, Tail::none, block);
    for (std::int64_t k = 0; k < 900; ++k) {
      if (k > 200 + 300 + 2 * 16) {
        ASSERT_EQ(convolution.history().cwiseAbs().maxCoeff(), 0) << k;
      }
      convolution.push(c.x.col(k));
    }
  }
}

/// A response that is linear from sample 50 on, given once by 60 samples with a linear tail and once in full.
TEST(LinearTail, goes_on_as_a_longer_table_does) {
  Case c = random_case(2, 2, 700, 700, 0.6, 9);
  for (std::int64_t l = 51; l < 700; ++l)
    for (int e = 0; e < 4; ++e)
      c.response[l * 4 + e] = c.response[50 * 4 + e] + 0.03 * (e + 1) * static_cast<double>(l - 50);
  const std::span<const double> whole(c.response), cut = whole.first(60 * 4);
  EXPECT_LT(Convolution::departure(cut, 2, 2), 1e-14);
  EXPECT_GT(Convolution::departure(whole.first(53 * 4), 2, 2), 1e-3);
  for (const int block : {1, 8}) {
    Convolution with_tail(cut, 2, 2, Tail::linear, block);
    for (std::int64_t k = 0; k < 700; ++k) {
      const Eigen::VectorXd exact = c.sum(k);
      // 1e-11: the slope is a difference over 6 steps that is extrapolated over 640
      ASSERT_LT((with_tail.history() - exact).cwiseAbs().maxCoeff(), 1e-11 * (1 + exact.norm())) << k;
      with_tail.push(c.x.col(k));
    }
  }
}

#if RICOCHET_HEAP_COUNTED
TEST(Convolution, takes_no_memory_as_it_goes) {
  const Case c = random_case(6, 3, 500, 2000, 0.5, 11);
  for (const int block : {1, 0}) {
    Convolution convolution(c.response, 6, 3, Tail::linear, block);
    Eigen::VectorXd x(3);
    const long before = heap_counter::calls;
    for (std::int64_t k = 0; k < 2000; ++k) {
      x = c.x.col(k);
      convolution.push(x);
    }
    EXPECT_EQ(heap_counter::calls, before);
  }
}
#endif

}  // namespace convolution_test
