// SPDX-License-Identifier: BSD-2-Clause
// Truncation of the modes that contact does not need.
#include <gtest/gtest.h>

#include "tests/kernels/dense_band.hpp"
#include "tests/kernels/sample.hpp"

namespace ricochet::kernels {
namespace keeping_test {

using namespace test_band;
using test::sample_kernel;

/// A kernel with three rigid modes and elastic modes from below to above the band.
/// Four elastic modes vanish on the surface.
Kernel kernel_of(int components) {
  constexpr std::size_t n = 40;
  Kernel kernel = sample_kernel(components, n, 4);
  for (std::size_t k = 0; k < n; ++k)
    kernel.modes.angular_frequency[k] = k < 3 ? 0.0 : band.value * 0.1 * std::pow(1.15, double(k));
  for (std::size_t i = 0; i < kernel.surface.shape.size(); ++i)
    for (const std::size_t k : {3U, 10U, 11U, 39U})
      if (i % n == k) kernel.surface.shape[i] = 0;
  kernel.modes.coriolis.pair = {3, 4, 20, 21};  // of elastic modes
  return kernel;
}

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// An array of a kernel as a row-major matrix with `columns` columns.
template <class T>
RowMajor array_of(const std::vector<T>& values, std::size_t columns) {
  EXPECT_EQ(values.size() % columns, 0U);
  const Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> array =
      Eigen::Map<const Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
          values.data(), static_cast<Index>(values.size() / columns), static_cast<Index>(columns));
  return array.template cast<double>();
}

Set elastic_modes(const Kernel& kernel) {
  const RowMajor shape = array_of(kernel.surface.shape, kernel.modes.size());
  const VectorXd omega = array_of(kernel.modes.angular_frequency, 1);
  Set set{VectorXd(0), MatrixXd(shape.rows(), 0)};
  for (Index k = 0; k < omega.size(); ++k) {
    if (omega[k] == 0) continue;
    set.lambda.conservativeResize(set.size() + 1);
    set.trace.conservativeResize(Eigen::NoChange, set.size());
    set.lambda[set.size() - 1] = omega[k] * omega[k];
    set.trace.col(set.size() - 1) = shape.col(k);
  }
  return set;
}

/// Indices of the remaining modes, identified by their frequencies. The rigid modes come first.
Order left_in(const Kernel& kernel, const Kernel& whole) {
  Order columns;
  std::size_t rigid = 0;
  for (const double omega : kernel.modes.angular_frequency) {
    const auto& all = whole.modes.angular_frequency;
    columns.push_back(omega == 0 ? rigid++
                                 : static_cast<std::size_t>(std::ranges::find(all, omega) - all.begin()));
  }
  return columns;
}

class Keeping : public testing::TestWithParam<int> {
 protected:
  Keeping() : whole_(kernel_of(GetParam())) {}

  /// The kernel after removal of the least contributing modes, up to the flexibility error `error`.
  Kernel kept(double error) {
    Kernel kernel = whole_;
    made_ = truncate_least_contributing(kernel, band, error);
    return kernel;
  }
  /// Flags of the truncated elastic modes.
  Choice gone(const Kernel& kernel) const {
    Choice gone(whole_.modes.size() - 3, true);
    for (const std::size_t k : left_in(kernel, whole_))
      if (k >= 3) gone[k - 3] = false;
    return gone;
  }

  Kernel whole_;
  double made_ = -1;
};
INSTANTIATE_TEST_SUITE_P(OneAndThreeComponents, Keeping, testing::Values(1, 3));

TEST_P(Keeping, contributing_modes_reports_its_error_which_is_within_the_bound) {
  const Set modes = elastic_modes(whole_);
  std::size_t last = 4;
  for (const double bound : {1e-4, 1e-3, 0.01, 0.05, 0.2}) {
    const Kernel kernel = kept(bound);
    EXPECT_NO_THROW(validate(kernel, "origin"));
    const Choice left_out = gone(kernel);
    const auto number = static_cast<std::size_t>(std::ranges::count(left_out, true));
    EXPECT_EQ(kernel.modes.size(), whole_.modes.size() - number);
    const double error = dense_error_without(modes, left_out);
    EXPECT_NEAR(made_, error, 1e-12 * (1 + error));
    EXPECT_LE(error, bound);
    // A larger bound never keeps more modes.
    EXPECT_GE(number, last);
    last = number;
  }
  EXPECT_GT(last, 10U);
}

TEST_P(Keeping, modes_up_to_an_end_has_the_reported_error) {
  for (const double share : {0.0, 0.3, 1.0, 1.7}) {
    const RadPerSecond end{share * band.value};
    const Kernel kernel = truncated_above(whole_, end);
    EXPECT_EQ(kernel.modes.size(), 3 + static_cast<std::size_t>(std::ranges::count_if(
                                           whole_.modes.angular_frequency,
                                           [&](double omega) { return omega > 0 && omega <= end.value; })));
    EXPECT_NO_THROW(validate(kernel, "origin"));
    const double error = dense_error_without(elastic_modes(whole_), gone(kernel));
    EXPECT_NEAR(truncation_error(whole_, end, band), error, 1e-12 * (1 + error));
  }
}

// Truncation of one more mode in the order of contributions would exceed the bound.
TEST_P(Keeping, contributing_modes_keeps_no_more_than_necessary) {
  const Set modes = elastic_modes(whole_);
  const Choice left_out = gone(kept(0.05));
  double least = 1e300;
  std::size_t next = 0;
  double most = 0;
  for (std::size_t k = 0; k < left_out.size(); ++k) {
    Choice alone(left_out.size(), false);
    alone[k] = true;
    const double error = dense_error_without(modes, alone);
    if (left_out[k]) {
      most = std::max(most, error);
    } else if (error < least) {
      least = error;
      next = k;
    }
  }
  EXPECT_LT(most, least);
  Choice more = left_out;
  more[next] = true;
  EXPECT_GT(dense_error_without(modes, more), 0.05);
}

TEST_P(Keeping, contributing_modes_preserves_static_responses) {
  const auto rows = static_cast<std::size_t>(4 * GetParam());
  const auto flexibility = [&](const Kernel& kernel) -> MatrixXd {
    return elastic_modes(kernel).flexibility(0).real() + array_of(kernel.surface.residual_flexibility, rows);
  };
  const auto under_gravity = [&](const Kernel& kernel) -> MatrixXd {
    const Set modes = elastic_modes(kernel);
    const RowMajor force = array_of(kernel.loads.body_force, kernel.modes.size());
    return modes.trace * modes.lambda.cwiseInverse().asDiagonal() *
               force.rightCols(modes.size()).transpose() +
           array_of(kernel.loads.body_force_residual, 3);
  };
  // Static response at the outputs: the sum of (seen · acting)/λ over the modes, plus the residual.
  const auto responses = [&](const Kernel& kernel) {
    const std::size_t n = kernel.modes.size();
    const MatrixXd inverse = elastic_modes(kernel).lambda.cwiseInverse().asDiagonal();
    const auto elastic = [&](const std::vector<double>& values) -> MatrixXd {
      return array_of(values, n).rightCols(inverse.rows());
    };
    std::vector<MatrixXd> all;
    const Kernel& k = kernel;
    for (std::size_t l = 0; l < k.applied.size(); ++l) {
      const MatrixXd acting = inverse * elastic(k.applied[l].participation).transpose();
      all.push_back(elastic(k.surface.shape) * acting + array_of(k.applied[l].residual, 3));
      for (const Receiver& receiver : k.receivers)
        all.push_back(elastic(receiver.shape) * acting +
                      array_of(receiver.load_residual, 6).middleCols(3 * static_cast<Index>(l), 3));
    }
    for (const Receiver& receiver : k.receivers) {
      all.push_back(elastic(receiver.shape) * inverse * elastic(k.surface.shape).transpose() +
                    array_of(receiver.residual_flexibility, rows));
      all.push_back(elastic(receiver.shape) * inverse * elastic(k.loads.body_force).transpose() +
                    array_of(receiver.body_force_residual, 3));
      // The response to a slowly moving support is unchanged: Ψ = (Ψ − ΦΓ) + ΦΓ.
      all.push_back(elastic(receiver.shape) * elastic(k.motions[0].participation).transpose() +
                    array_of(receiver.motion_residual, 3));
    }
    if (k.view) {  // the visualisation surface, third from the end
      const RowMajor view = array_of(k.view->shape, n).rightCols(inverse.rows());
      MatrixXd seen(9, rows + 3 + 6 + 3);
      seen << array_of(k.view->residual_flexibility, rows), array_of(k.view->body_force_residual, 3),
          array_of(k.view->load_residual, 6), array_of(k.view->motion_residual, 3);
      MatrixXd acting(inverse.rows(), seen.cols());
      acting << inverse * elastic(k.surface.shape).transpose(),
          inverse * elastic(k.loads.body_force).transpose(),
          inverse * elastic(k.applied[0].participation).transpose(),
          inverse * elastic(k.applied[1].participation).transpose(),
          elastic(k.motions[0].participation).transpose();
      all.push_back(view * acting + seen);
    }
    all.push_back(elastic(k.surface.shape) * elastic(k.motions[0].participation).transpose() +
                  array_of(k.motions[0].residual, 3));
    all.push_back(elastic(k.loads.body_force) * elastic(k.motions[0].participation).transpose() +
                  array_of(k.motions[0].momentum, 3));
    return all;
  };
  const MatrixXd before = flexibility(whole_), sunk = under_gravity(whole_);
  const std::vector<MatrixXd> moved = responses(whole_);
  for (const double bound : {1e-3, 0.05, 100.0}) {
    const Kernel kernel = kept(bound);
    ASSERT_LT(kernel.modes.size(), whole_.modes.size() - 4);
    EXPECT_LT((flexibility(kernel) - before).norm(), 1e-12 * before.norm());
    EXPECT_LT((under_gravity(kernel) - sunk).norm(), 1e-12 * sunk.norm());
    const std::vector<MatrixXd> now = responses(kernel);
    ASSERT_EQ(now.size(), moved.size());
    for (std::size_t i = 0; i < now.size(); ++i)
      EXPECT_LT((now[i] - moved[i]).norm(), (i + 3 == now.size() ? 1e-6 : 1e-12) * moved[i].norm())
          << i;  // 1e-6: single precision
  }
}

TEST_P(Keeping, contributing_modes_keeps_complete_columns) {
  const std::size_t n = whole_.modes.size();
  const Kernel kernel = kept(0.05);
  const Order columns = left_in(kernel, whole_);
  const std::size_t left = kernel.modes.size();
  ASSERT_EQ(columns.size(), left);
  ASSERT_LT(left, n - 4);
  EXPECT_TRUE(std::ranges::is_sorted(columns));
  const auto expect_columns = [&](const auto& now, const auto& before, std::size_t rows) {
    ASSERT_EQ(now.size(), rows * left);
    for (std::size_t i = 0; i < rows; ++i)
      for (std::size_t k = 0; k < left; ++k) ASSERT_EQ(now[i * left + k], before[i * n + columns[k]]);
  };
  expect_columns(kernel.modes.decay_rate, whole_.modes.decay_rate, 1);
  expect_columns(kernel.modes.residual, whole_.modes.residual, 1);
  expect_columns(kernel.surface.shape, whole_.surface.shape, static_cast<std::size_t>(4 * GetParam()));
  expect_columns(kernel.loads.body_force, whole_.loads.body_force, 3);
  expect_columns(kernel.loads.rotation, whole_.loads.rotation, 3);
  expect_columns(kernel.applied[1].participation, whole_.applied[1].participation, 3);
  expect_columns(kernel.motions[0].participation, whole_.motions[0].participation, 3);
  expect_columns(kernel.receivers[1].shape, whole_.receivers[1].shape, 3);
  expect_columns(kernel.view->shape, whole_.view->shape, 9);
  EXPECT_EQ(kernel.view->node, whole_.view->node);
  EXPECT_EQ(kernel.surface.node, whole_.surface.node);
}

TEST_P(Keeping, contributing_modes_never_truncates_rigid_modes) {
  const Kernel kernel = kept(100.0);
  EXPECT_EQ(kernel.modes.angular_frequency, std::vector<double>(3, 0.0));
  const double all = dense_error_without(elastic_modes(whole_), Choice(37, true));
  EXPECT_NEAR(made_, all, 1e-12 * all);
}

TEST_P(Keeping, every_contributing_mode_truncates_only_modes_that_vanish_on_the_surface) {
  const Kernel kernel = kept(0);
  EXPECT_EQ(made_, 0);
  Choice unseen(37, false);
  for (const std::size_t k : {3U, 10U, 11U, 39U}) unseen[k - 3] = true;
  EXPECT_EQ(gone(kernel), unseen);
  EXPECT_EQ(kernel.surface.residual_flexibility, whole_.surface.residual_flexibility);
  EXPECT_EQ(kernel.loads.body_force_residual, whole_.loads.body_force_residual);
}

TEST_P(Keeping, contributing_modes_needs_no_visualisation_surface) {
  whole_.view.reset();
  const Kernel kernel = kept(0.05);
  EXPECT_FALSE(kernel.view);
  EXPECT_LT(kernel.modes.size(), whole_.modes.size() - 4);
}

TEST_P(Keeping, contributing_modes_of_a_rigid_body_keeps_all) {
  whole_.modes.angular_frequency.assign(whole_.modes.size(), 0.0);
  EXPECT_EQ(kept(0.5).modes.size(), whole_.modes.size());
  EXPECT_EQ(made_, 0);
}

}  // namespace keeping_test
}  // namespace ricochet::kernels
