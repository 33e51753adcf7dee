// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/slicing.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ricochet::modes {

CountModel::CountModel(std::int64_t rigid, std::vector<Probe> probes, ExpectedCount expected)
    : rigid_(static_cast<double>(rigid)), expected_(std::move(expected)) {
  std::sort(probes.begin(), probes.end(), [](const Probe& a, const Probe& b) { return a.sigma < b.sigma; });
  // A half is added to each count, so that none is 0.
  for (const Probe& probe : probes) {
    const double expects = std::log(expected_(probe.sigma) + 0.5);
    if (!known_.empty() && expects <= known_.back().expected) continue;
    known_.push_back({expects, std::log(std::max(0.0, static_cast<double>(probe.below) - rigid_) + 0.5)});
    highest_ = probe.sigma;
  }
}

double CountModel::count_at(double lambda) const {
  if (lambda <= 0) return rigid_;
  if (known_.empty()) return rigid_ + expected_(lambda);
  const double at = std::log(expected_(lambda) + 0.5);
  const auto above = std::ranges::find_if(known_, [&](const Known& one) { return one.expected >= at; });
  const Known& below = above == known_.begin() ? *above : *std::prev(above);
  double power = 1;
  if (above == known_.end()) {
    // The power goes half of its way back to 1. A probe that is too close to the last one does not determine
    // it.
    const auto before = std::find_if(known_.rbegin(), known_.rend(), [&](const Known& one) {
      return one.expected < below.expected + std::log(0.7);
    });
    if (before != known_.rend())
      power = 0.5 + 0.5 * (below.count - before->count) / (below.expected - before->expected);
  } else if (above != known_.begin()) {
    power = (above->count - below.count) / (above->expected - below.expected);
  }
  return rigid_ + std::exp(below.count + power * (at - below.expected)) - 0.5;
}

double CountModel::lambda_at(double count) const {
  double low = 0, high = highest_;
  while (count_at(high) < count) high *= 2;
  for (int k = 0; k < 100; ++k) {
    const double middle = (low + high) / 2;
    (count_at(middle) < count ? low : high) = middle;
  }
  return high;
}

double expected_vectors(const CountModel& model, const Interval& interval) {
  const double middle = (interval.from + interval.to) / 2, half = 1.5 * (interval.to - interval.from) / 2;
  return 1.9 * (model.count_at(middle + half) - model.count_at(middle - half));
}

namespace {

/// The ends of `number` intervals in [0, end] that take the same time.
std::vector<double> bounds_of(const CountModel& model, double end, int number) {
  const auto work = [&](double from, double to) { return expected_vectors(model, Interval{from, to}); };
  constexpr int bisections = 50;
  const auto filled = [&](double share) {
    std::vector<double> bound{0};
    while (std::ssize(bound) <= number && bound.back() < end) {
      double low = bound.back(), high = end;
      for (int k = 0; k < bisections && work(bound.back(), high) > share; ++k) {
        const double middle = (low + high) / 2;
        (work(bound.back(), middle) < share ? low : high) = middle;
      }
      bound.push_back(high);
    }
    return bound;
  };
  double least = 0, most = work(0, end);
  for (int k = 0; k < bisections; ++k) {
    const double share = (least + most) / 2;
    (filled(share).back() < end ? least : most) = share;
  }
  return filled(most);
}

}  // namespace

std::vector<Task> plan_shifts(const CountModel& model, double end, std::int64_t modes_per_shift, int teams) {
  const double elastic = std::max(1.0, model.count_at(end) - model.count_at(0));
  // A few modes are not worth a factorisation in each team.
  const double full = static_cast<double>(modes_per_shift);
  auto shifts = static_cast<int>(std::max(1.0, std::ceil(elastic / full - 0.1)));
  if (elastic > 0.2 * full) shifts = (shifts + teams - 1) / teams * teams;
  const std::vector<double> bound = bounds_of(model, end, shifts);
  std::vector<Task> tasks;
  for (std::size_t k = 0; k + 1 < bound.size(); ++k) {
    const double from = bound[k], to = bound[k + 1];
    const double overlap = 1.5 * (to - from) / std::max(4.0, model.count_at(to) - model.count_at(from));
    tasks.push_back(
        {(from + to) / 2, {k == 0 ? 0 : from - overlap, to == end ? end * (1 + 1e-5) : to + overlap}});
  }
  return tasks;
}

double expected_vectors(const CountModel& model, const Task& task) {
  const double reach = std::max(task.sigma - task.wanted.from, task.wanted.to - task.sigma);
  return expected_vectors(model, Interval{std::max(0.0, task.sigma - reach), task.sigma + reach});
}

namespace {

/// The vectors of all rounds; each waits for the largest task.
double vectors_of(const CountModel& model, const std::vector<Task>& ascending, int teams) {
  const std::vector<Task> tasks = in_order(ascending, teams);
  double sum = 0, largest = 0;
  for (std::size_t k = 0; k < tasks.size(); ++k) {
    if (k % static_cast<std::size_t>(teams) == 0) sum += std::exchange(largest, 0);
    largest = std::max(largest, expected_vectors(model, tasks[k]));
  }
  return sum + largest;
}

/// Tasks up to `end`, with the highest shift at `sigma`. Its interval takes as many vectors as those of
/// `ideal`, or reaches as far below the shift as the end is above it.
std::vector<Task> plan_under(const CountModel& model, double end, std::int64_t modes_per_shift, double sigma,
                             const std::vector<Task>& ideal) {
  const double wanted = expected_vectors(model, ideal.back());
  double reach = 0, most = sigma;
  for (int k = 0; k < 50; ++k) {
    const double middle = (reach + most) / 2;
    (expected_vectors(model, Interval{sigma - middle, sigma + middle}) < wanted ? reach : most) = middle;
  }
  const double from = sigma - std::max(reach, end - sigma), few = 0.1 * static_cast<double>(modes_per_shift);
  const double to = end * (1 + 1e-5);
  if (from <= 0 || model.count_at(from) - model.count_at(0) < few) return {{sigma, {0, to}}};
  std::vector<Task> tasks = plan_shifts(model, from, modes_per_shift, 1);
  const double overlap = 1.5 * (end - from) / std::max(4.0, model.count_at(end) - model.count_at(from));
  tasks.back().wanted.to = from + overlap;
  tasks.push_back({sigma, {from - overlap, to}});
  return tasks;
}

}  // namespace

std::vector<Task> in_order(const std::vector<Task>& ascending, int number) {
  const auto teams = static_cast<std::size_t>(number);
  if (ascending.size() % teams != 0) return ascending;
  const std::size_t each = ascending.size() / teams;
  std::vector<Task> tasks;
  for (std::size_t round = 1; round <= each; ++round)
    for (std::size_t t = 0; t < teams; ++t) tasks.push_back(ascending[(t + 1) * each - round]);
  return tasks;
}

std::optional<std::vector<Task>> plan_about(const CountModel& model, double end, std::int64_t modes_per_shift,
                                            const std::vector<double>& factored) {
  const std::size_t teams = factored.size();
  const int number = static_cast<int>(teams);
  const std::vector<Task> ideal = plan_shifts(model, end, modes_per_shift, number);
  std::vector<Task> tasks = ideal;
  if (teams == 1) {
    tasks = plan_under(model, end, modes_per_shift, factored.front(), ideal);
    // Another shift instead costs a factorisation, too.
    if (tasks.size() > ideal.size() + 1) return std::nullopt;
  } else if (ideal.size() % teams != 0) {
    return std::nullopt;
  } else {
    const std::size_t each = ideal.size() / teams;
    for (std::size_t t = 0; t < teams; ++t) tasks[(t + 1) * each - 1].sigma = factored[t];
  }
  // More vectors than this cost more than the factorisations of another plan.
  constexpr double most = 1.2;
  if (vectors_of(model, tasks, number) > most * vectors_of(model, ideal, number)) return std::nullopt;
  for (const Task& task : tasks)
    if (expected_vectors(model, task) > most_vectors * static_cast<double>(modes_per_shift))
      return std::nullopt;
  return tasks;
}

namespace {

/// Returns the middle of the widest gap in [from, to] without an eigenvalue of either slice.
double widest_gap(const Slice& a, const Slice& b, double from, double to) {
  std::vector<double> at{from, to};
  for (const Slice* slice : {&a, &b})
    for (double lambda : slice->lambda)
      if (lambda > from && lambda < to) at.push_back(lambda);
  std::sort(at.begin(), at.end());
  std::size_t best = 1;
  for (std::size_t k = 1; k < at.size(); ++k)
    if (at[k] - at[k - 1] > at[best] - at[best - 1]) best = k;
  return (at[best - 1] + at[best]) / 2;
}

}  // namespace

Stitched stitch(std::int64_t rigid, const std::vector<Slice>& all, const Probe& end) {
  Stitched result;
  result.share.resize(all.size());
  // A slice with its shift above the end serves below it, as if the end were its shift.
  std::vector<Slice> slices;
  for (const Slice& slice : all) {
    if (!slices.empty() && slices.back().probe.sigma >= end.sigma) break;
    slices.push_back(slice);
    if (slice.probe.sigma < end.sigma) continue;
    slices.back().probe = end;
    slices.back().covered.to = std::min(slice.covered.to, end.sigma);
    std::erase_if(slices.back().lambda, [&](double lambda) { return lambda >= end.sigma; });
  }
  const auto index = [](const Slice& slice, double lambda) {
    return static_cast<std::size_t>(std::lower_bound(slice.lambda.begin(), slice.lambda.end(), lambda) -
                                    slice.lambda.begin());
  };
  // Zero and the end are treated as slices without modes.
  const Slice bottom{{0, rigid}, {0, 0}, {}}, top{end, {end.sigma, end.sigma}, {}};
  for (std::size_t k = 0; k <= slices.size(); ++k) {
    const Slice &below = k == 0 ? bottom : slices[k - 1], &above = k == slices.size() ? top : slices[k];
    const double from = std::max(above.covered.from, below.probe.sigma),
                 to = std::min(below.covered.to, above.probe.sigma);
    if (from > to) {
      result.missing.push_back(
          {(from + to) / 2, {k == 0 ? 0 : (below.probe.sigma + to) / 2, (from + above.probe.sigma) / 2}});
      continue;
    }
    const double split = k == 0 ? 0 : k == slices.size() ? end.sigma : widest_gap(below, above, from, to);
    const std::size_t first = index(above, split), below_end = index(below, split);
    const std::size_t found =
        (below_end - index(below, below.probe.sigma)) + (index(above, above.probe.sigma) - first);
    if (static_cast<std::int64_t>(found) != above.probe.below - below.probe.below)
      result.missing.push_back(
          {(below.probe.sigma + above.probe.sigma) / 2, {below.probe.sigma, above.probe.sigma}});
    if (k > 0) result.share[k - 1].end = below_end;
    if (k < slices.size()) result.share[k].first = first;
  }
  return result;
}

}  // namespace ricochet::modes
