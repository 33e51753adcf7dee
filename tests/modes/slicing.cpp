// SPDX-License-Identifier: BSD-2-Clause
// Spectrum slicing: the choice of shifts and the proof of completeness, as pure functions of counts and
// eigenvalues.
#include "src/modes/slicing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace ricochet::modes {
namespace slicing_test {

/// Spectrum of an invented body: six rigid modes, then λ_k = k^1.3, where every tenth is double.
std::vector<double> spectrum() {
  std::vector<double> lambda;
  for (int k = 1; k <= 400; ++k) {
    lambda.push_back(std::pow(k, 1.3));
    if (k % 10 == 0) lambda.push_back(lambda.back());
  }
  return lambda;
}
constexpr std::int64_t rigid = 6;

/// An estimate that knows nothing of the body.
double proportional(double lambda) { return lambda; }

Probe probe_at(const std::vector<double>& lambda, double sigma) {
  return {sigma, rigid + (std::lower_bound(lambda.begin(), lambda.end(), sigma) - lambda.begin())};
}

/// The result of a perfect iteration for a task.
Slice slice_of(const std::vector<double>& lambda, const Task& task) {
  Slice slice{probe_at(lambda, task.sigma), task.wanted, {}};
  for (double value : lambda)
    if (value >= task.wanted.from && value <= task.wanted.to) slice.lambda.push_back(value);
  return slice;
}

struct Case {
  std::vector<double> lambda = spectrum();
  Probe end = probe_at(lambda, 1500.5);
  std::vector<Slice> slices;

  explicit Case(int teams = 2, std::int64_t modes_per_shift = 60) {
    const CountModel model(rigid, {probe_at(lambda, 600.5), end}, proportional);
    for (const Task& task : plan_shifts(model, end.sigma, modes_per_shift, teams))
      slices.push_back(slice_of(lambda, task));
  }
  std::vector<double> kept(const Stitched& stitched) const {
    std::vector<double> all;
    for (std::size_t s = 0; s < slices.size(); ++s)
      all.insert(all.end(), slices[s].lambda.begin() + static_cast<std::ptrdiff_t>(stitched.share[s].first),
                 slices[s].lambda.begin() + static_cast<std::ptrdiff_t>(stitched.share[s].end));
    return all;
  }
};

TEST(Plan, covers_the_spectrum_with_a_multiple_of_the_teams_and_about_the_requested_modes_each) {
  for (int teams : {1, 2, 3, 5}) {
    const Case made(teams, 60);
    EXPECT_EQ(made.slices.size() % static_cast<std::size_t>(teams), 0u);
    EXPECT_EQ(made.slices.front().covered.from, 0);
    EXPECT_GE(made.slices.back().covered.to, made.end.sigma);
    for (std::size_t s = 0; s < made.slices.size(); ++s) {
      EXPECT_LE(made.slices[s].lambda.size(), 60u * 3 / 2) << s;
      EXPECT_GT(made.slices[s].probe.sigma, made.slices[s].covered.from);
      EXPECT_LT(made.slices[s].probe.sigma, made.slices[s].covered.to);
      if (s > 0) {
        EXPECT_LT(made.slices[s].covered.from, made.slices[s - 1].covered.to) << "no overlap";
      }
    }
  }
}

TEST(CountModel, goes_through_its_probes_and_inverts_itself) {
  const auto lambda = spectrum();
  const std::vector<Probe> probes{probe_at(lambda, 40.5), probe_at(lambda, 300.5), probe_at(lambda, 1500.5)};
  const CountModel model(rigid, probes, proportional);
  for (const Probe& probe : probes)
    EXPECT_NEAR(model.count_at(probe.sigma), static_cast<double>(probe.below), 1e-9);
  for (double count : {10.0, 50.0, 200.0, 250.0})
    EXPECT_NEAR(model.count_at(model.lambda_at(count)), count, 1e-6);
}

TEST(CountModel, never_decreases_between_the_counts_of_multiplets) {
  // Twenty nearly equal eigenvalues at 100, and none until 150: one probe above, two within the gap.
  const std::vector<Probe> probes{
      {50, 6 + 30}, {99.9, 6 + 60}, {100.1, 6 + 80}, {149, 6 + 80}, {200, 6 + 110}};
  const CountModel model(rigid, probes, [](double lambda) { return std::pow(lambda, 1.5) / 25; });
  for (const Probe& probe : probes)
    EXPECT_NEAR(model.count_at(probe.sigma), static_cast<double>(probe.below), 1e-9);
  double last = 0;
  for (double lambda = 1; lambda < 1000; lambda *= 1.01) {
    EXPECT_GE(model.count_at(lambda), last - 1e-9) << lambda;
    last = model.count_at(lambda);
  }
  EXPECT_NEAR(model.count_at(model.lambda_at(75)), 75, 1e-6);
}

TEST(Plan, makes_use_of_the_shifts_that_were_factored) {
  const auto lambda = spectrum();
  const Probe end = probe_at(lambda, 1500.5);
  const CountModel model(rigid, {probe_at(lambda, 600.5), end}, proportional);
  for (const int teams : {1, 2, 3}) {
    const std::vector<Task> ideal = plan_shifts(model, end.sigma, 60, teams);
    const std::size_t each = ideal.size() / static_cast<std::size_t>(teams);
    for (const double moved : {-0.05, 0.0, 0.2}) {
      SCOPED_TRACE(testing::Message() << teams << " teams, moved by " << moved);
      std::vector<double> factored;
      for (std::size_t t = 0; t < static_cast<std::size_t>(teams); ++t) {
        const Task& task = ideal[(t + 1) * each - 1];
        factored.push_back(task.sigma + moved * (task.wanted.to - task.wanted.from) / 2);
      }
      const auto plan = plan_about(model, end.sigma, 60, factored);
      ASSERT_TRUE(plan.has_value());
      const std::vector<Task> first = in_order(*plan, teams);
      for (std::size_t t = 0; t < factored.size(); ++t) EXPECT_EQ(first[t].sigma, factored[t]);
      EXPECT_EQ(plan->front().wanted.from, 0);
      EXPECT_GT(plan->back().wanted.to, end.sigma);
      for (std::size_t s = 1; s < plan->size(); ++s) {
        EXPECT_LT((*plan)[s].wanted.from, (*plan)[s - 1].wanted.to) << "no overlap";
        EXPECT_LT((*plan)[s - 1].sigma, (*plan)[s].sigma);
      }
      EXPECT_LE(plan->size(), ideal.size() + 1);
    }
    // Shifts that are of no use: at a third of their places.
    std::vector<double> low;
    for (std::size_t t = 0; t < static_cast<std::size_t>(teams); ++t)
      low.push_back(ideal[(t + 1) * each - 1].sigma / 3);
    EXPECT_FALSE(plan_about(model, end.sigma, 60, low).has_value()) << teams;
  }
}

TEST(Stitch, keeps_every_eigenvalue_below_the_end_once) {
  for (int teams : {1, 2, 3}) {
    const Case made(teams);
    const Stitched stitched = stitch(rigid, made.slices, made.end);
    EXPECT_TRUE(stitched.missing.empty());
    std::vector<double> below;
    for (double value : made.lambda)
      if (value < made.end.sigma) below.push_back(value);
    EXPECT_EQ(made.kept(stitched), below);
  }
}

TEST(Stitch, misses_any_single_eigenvalue_that_is_taken_away) {
  const Case whole;
  for (std::size_t victim = 0; whole.lambda[victim] < whole.end.sigma; ++victim) {
    Case made;
    for (Slice& slice : made.slices) {
      const auto found = std::find(slice.lambda.begin(), slice.lambda.end(), whole.lambda[victim]);
      if (found != slice.lambda.end()) slice.lambda.erase(found);
    }
    const Stitched stitched = stitch(rigid, made.slices, made.end);
    ASSERT_FALSE(stitched.missing.empty()) << "mode " << victim;
    // The interval of the new shift contains the missing eigenvalue.
    EXPECT_TRUE(std::any_of(stitched.missing.begin(), stitched.missing.end(),
                            [&](const Task& task) {
                              return task.wanted.from <= whole.lambda[victim] &&
                                     whole.lambda[victim] <= task.wanted.to;
                            }))
        << "mode " << victim;
  }
}

TEST(Stitch, notices_an_eigenvalue_too_many) {
  Case made;
  Slice& slice = made.slices[1];
  slice.lambda.insert(std::upper_bound(slice.lambda.begin(), slice.lambda.end(), slice.probe.sigma),
                      slice.probe.sigma * 1.0001);
  EXPECT_FALSE(stitch(rigid, made.slices, made.end).missing.empty());
}

TEST(Stitch, requests_what_no_slice_covers_and_accepts_the_result) {
  for (std::size_t short_one : {0u, 1u, 3u}) {
    Case made;
    // A slice whose basis was exhausted before its interval was covered, on both sides of the shift.
    Slice& slice = made.slices[short_one];
    const double sigma = slice.probe.sigma;
    slice.covered = {sigma - 0.2 * (sigma - slice.covered.from), sigma + 0.2 * (slice.covered.to - sigma)};
    std::erase_if(slice.lambda,
                  [&](double value) { return value < slice.covered.from || value > slice.covered.to; });
    Stitched stitched = stitch(rigid, made.slices, made.end);
    EXPECT_FALSE(stitched.missing.empty());
    for (int round = 0; round < 4 && !stitched.missing.empty(); ++round) {
      for (const Task& task : stitched.missing) made.slices.push_back(slice_of(made.lambda, task));
      std::sort(made.slices.begin(), made.slices.end(),
                [](const Slice& a, const Slice& b) { return a.probe.sigma < b.probe.sigma; });
      stitched = stitch(rigid, made.slices, made.end);
    }
    EXPECT_TRUE(stitched.missing.empty()) << short_one;
    EXPECT_EQ(static_cast<std::int64_t>(made.kept(stitched).size()), made.end.below - rigid);
  }
}

}  // namespace slicing_test
}  // namespace ricochet::modes
