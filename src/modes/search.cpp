// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "src/modes/dense.hpp"

namespace ricochet::modes {

namespace {

/// Relative distance to an eigenvalue below which round-off decides the count at a shift.
constexpr double too_close = 1e-7;

/// Largest number of columns of a Lanczos block.
constexpr Eigen::Index widest_block = 256;

double hertz(double lambda) { return std::sqrt(std::max(lambda, 0.0)) / (2 * std::numbers::pi); }

/// Performs the search in rounds; in each round, every team factors and iterates about one shift.
class Searcher {
 public:
  Searcher(const parallel::Teams& teams, const Operators& operators, Factorisation& factor,
           const Request& request, const Checkpoint& checkpoint, const Progress& progress)
      : teams_(teams),
        operators_(operators),
        progress_(progress),
        request_(request),
        rigid_(operators.below_zero),
        factor_(factor),
        checkpoint_(checkpoint) {
    options_.tolerance = request.relative_residual;
  }

  /// Finds the end of the search. Collective.
  Probe find_end() {
    request_.up_to ? probe_up_to(std::pow(static_cast<RadPerSecond>(*request_.up_to).value, 2))
                   : probe_for(*request_.count);
    return end_;
  }

  Search run() {
    std::vector<Task> tasks;
    if (const auto plan = checkpoint_.plan()) {
      end_ = plan->end;
      tasks = resume(plan->tasks);
    } else {
      progress_.begin("inertia counts");
      find_end();
      dense_ = request_.solver == Solver::dense || (request_.solver == Solver::fastest && can_be_dense() &&
                                                    dense_is_faster(rows(), end_.below - rigid_));
      tasks = dense_ ? dense_task()
                     : plan_shifts(CountModel(rigid_, probes_), end_.sigma, request_.modes_per_shift,
                                   teams_.count());
      checkpoint_.save({end_, tasks});
    }
    work(tasks);
    move_end_off_modes();
    if (is_complete()) return std::move(found_);
    dense_ = false;
    for (int round = 0; round < 8; ++round) {
      // Uses other start vectors, in case the previous ones had no component of the missing mode, and wider
      // blocks, because a block finds no more copies of a multiple mode than it has columns.
      ++options_.seed;
      options_.block = std::min<Eigen::Index>(2 * options_.block, widest_block);
      work(stitch(rigid_, found_.slices, end_).missing);
      if (is_complete()) return std::move(found_);
    }
    if (can_be_dense() && rows() <= most_dense_rows) {
      dense_ = true;
      found_ = {};
      work(dense_task());
      if (is_complete()) return std::move(found_);
    }
    const Interval gap = stitch(rigid_, found_.slices, end_).missing.front().wanted;
    throw SolverError(
        fmt::format("modes: inertia proves modes between {:.6g} and {:.6g} Hz that are not found",
                    hertz(gap.from), hertz(gap.to)));
  }

 private:
  std::int64_t rows() const { return operators_.total_rows; }

  /// Whether no eigenvalue below zero is left out; the dense solver needs a definite K − σM at some σ < 0.
  bool can_be_dense() const { return operators_.below_zero == operators_.rigid.cols(); }

  /// The task of all modes, about a shift in their middle.
  std::vector<Task> dense_task() const {
    return plan_shifts(CountModel(rigid_, probes_), end_.sigma, end_.below + 1, 1);
  }

  /// Divides the spectrum among the slices. Returns whether every inertia count agrees.
  bool is_complete() {
    Stitched stitched = stitch(rigid_, found_.slices, end_);
    found_.share = std::move(stitched.share);
    found_.end = end_;
    return stitched.missing.empty();
  }

  /// Takes over the stored slices and returns the remaining tasks.
  std::vector<Task> resume(std::vector<Task> tasks) {
    progress_.begin("slices from disk");
    const std::size_t planned = tasks.size();
    for (Checkpoint::Found& found : checkpoint_.slices()) {
      // The shift of a slice may differ slightly from that of its task, because it was moved off a mode.
      std::erase_if(
          tasks, [&](const Task& task) { return std::abs(found.slice.probe.sigma / task.sigma - 1) < 1e-5; });
      insert(std::move(found.slice), found.team, std::move(found.shape));
    }
    progress_.begin(fmt::format("{} of {} slices were there", planned - tasks.size(), planned));
    return tasks;
  }

  /// Returns the lists `mine` of all teams. Collective.
  std::vector<std::vector<double>> from_each_team(const std::vector<double>& mine) const {
    return parallel::exchange(
        teams_.peers(), std::vector<std::vector<double>>(static_cast<std::size_t>(teams_.count()), mine));
  }

  /// Counts the eigenvalues below each entry of `sigma`, one entry per team, and adds the counts to the
  /// probes.
  void probe(const std::vector<double>& sigma) {
    std::vector<double> mine;
    if (static_cast<std::size_t>(teams_.mine()) < sigma.size()) {
      factor_.factor(sigma[static_cast<std::size_t>(teams_.mine())]);
      mine = {factor_.sigma(), static_cast<double>(factor_.below())};
    }
    for (const auto& probe : from_each_team(mine))
      if (!probe.empty()) probes_.push_back({probe[0], static_cast<std::int64_t>(probe[1])});
  }

  void probe_up_to(double end) {
    std::vector<double> sigma;
    for (int t = 0; t < teams_.count(); ++t) sigma.push_back(end * (t + 1) / teams_.count());
    probe(sigma);
    end_ = probes_.back();
  }

  /// Probes until one shift has at least `count` eigenvalues below it, but only a few more.
  void probe_for(std::int64_t count) {
    const std::int64_t most = count + count / 8 + 8;
    const auto wanted = static_cast<double>(count);
    const double guess = request_.first_end > 0 ? request_.first_end : operators_.expected_end(wanted);
    std::vector<double> sigma;
    for (int t = 0; t < teams_.count(); ++t) sigma.push_back(guess * std::pow(2.0, t + 1 - teams_.count()));
    probe(sigma);
    for (int round = 0; round < 60; ++round) {
      double low = 0, high = std::numeric_limits<double>::infinity();
      std::int64_t at_high = 0;
      for (const Probe& probe : probes_) {
        if (probe.below < count) low = std::max(low, probe.sigma);
        if (probe.below >= count && probe.sigma < high) {
          high = probe.sigma;
          at_high = probe.below;
        }
      }
      if (at_high >= count && (at_high <= most || high - low < 1e-3 * high)) break;
      const CountModel model(rigid_, probes_);
      double next = model.lambda_at(wanted + 0.04 * wanted + 3);
      if (std::isinf(high)) {
        next = std::clamp(next, 1.1 * low, 8 * low);
      } else if (!(next > low + 0.05 * (high - low) && next < high - 0.05 * (high - low))) {
        next = (low + high) / 2;
      }
      probe({next});
    }
    end_.sigma = std::numeric_limits<double>::infinity();
    for (const Probe& probe : probes_)
      if (probe.below >= count && probe.sigma < end_.sigma) end_ = probe;
    if (std::isinf(end_.sigma))
      throw SolverError(fmt::format("modes: no frequency with {} modes below it is found", count));
  }

  /// Processes all tasks in rounds, one task per team. Collective.
  void work(const std::vector<Task>& tasks) {
    const auto teams = static_cast<std::size_t>(teams_.count());
    std::vector<std::vector<Task>> queue(teams);
    for (std::size_t k = 0; k < tasks.size(); ++k) queue[k % teams].push_back(tasks[k]);
    std::size_t rounds = 0;
    for (const auto& list : queue) rounds = std::max(rounds, list.size());
    total_ += rounds;
    for (std::size_t round = 0; round < rounds; ++round) {
      progress_.begin(teams > 1 ? fmt::format("slices, round {} of {} ({} at a time)", ++done_, total_, teams)
                                : fmt::format("slice {} of {}", ++done_, total_));
      const auto& mine = queue[static_cast<std::size_t>(teams_.mine())];
      std::vector<double> message;
      Converged converged;
      std::string complaint;
      if (round < mine.size()) {
        converged = solve(mine[round]);
        try {
          checkpoint_.save(Slice{{factor_.sigma(), factor_.below()},
                                 converged.covered,
                                 {converged.lambda.begin(), converged.lambda.end()}},
                           converged.shape);
        } catch (const InputError& error) {
          complaint = error.what();
        }
        message = {factor_.sigma(), static_cast<double>(factor_.below()), converged.covered.from,
                   converged.covered.to};
        message.insert(message.end(), converged.lambda.begin(), converged.lambda.end());
      }
      // If one team cannot write its slice, all ranks throw.
      parallel::agree(teams_.world(), complaint);
      const auto all = from_each_team(message);
      for (std::size_t t = 0; t < teams; ++t)
        if (!all[t].empty()) {
          const auto& m = all[t];
          insert({{m[0], static_cast<std::int64_t>(m[1])}, {m[2], m[3]}, {m.begin() + 4, m.end()}},
                 static_cast<int>(t),
                 static_cast<int>(t) == teams_.mine() ? std::move(converged.shape) : Eigen::MatrixXd());
        }
    }
  }

  /// Raises the end if it coincides with a mode, and counts again.
  void move_end_off_modes() {
    const auto hit = [&] {
      for (const Slice& slice : found_.slices)
        for (double lambda : slice.lambda)
          if (std::abs(lambda / end_.sigma - 1) < too_close) return true;
      return false;
    };
    if (!hit()) return;
    while (hit()) end_.sigma *= 1 + 10 * too_close;
    probe({end_.sigma});
    end_ = probes_.back();
  }

  /// Computes all modes of a task. Raises the shift if it coincides with a mode.
  Converged solve(const Task& task) {
    double sigma = task.sigma;
    const parallel::Progress bar = [&](std::int64_t done, std::int64_t) {
      progress_.at(done, request_.modes_per_shift);
    };
    for (int attempt = 0; attempt < 6; ++attempt) {
      factor_.factor(sigma);
      Converged converged = dense_ ? dense_modes(operators_, factor_.entries(), task.wanted)
                                   : lanczos(operators_, factor_, task.wanted, options_, bar);
      const Eigen::ArrayXd distance = (converged.lambda.array() / factor_.sigma() - 1).abs();
      if (distance.size() == 0 || distance.minCoeff() > too_close) return converged;
      sigma = (1 + 10 * too_close) * factor_.sigma();
    }
    throw SolverError(fmt::format("modes: no shift near {:.6g} Hz is clear of modes", hertz(task.sigma)));
  }

  void insert(Slice slice, int team, Eigen::MatrixXd&& shape) {
    const auto place =
        std::lower_bound(found_.slices.begin(), found_.slices.end(), slice,
                         [](const Slice& a, const Slice& b) { return a.probe.sigma < b.probe.sigma; }) -
        found_.slices.begin();
    found_.slices.insert(found_.slices.begin() + place, std::move(slice));
    found_.team.insert(found_.team.begin() + place, team);
    found_.shape.insert(found_.shape.begin() + place, std::move(shape));
  }

  const parallel::Teams& teams_;
  const Operators& operators_;
  const Progress progress_;
  const Request& request_;
  std::int64_t rigid_;
  LanczosOptions options_;
  bool dense_ = false;  ///< whether slices are computed by the dense solver
  Factorisation& factor_;
  const Checkpoint& checkpoint_;
  Probe end_;
  std::vector<Probe> probes_;
  Search found_;
  std::size_t done_ = 0, total_ = 0;
};

}  // namespace

double expected_mib(const Factorisation& factor, std::int64_t local_rows, std::int64_t modes,
                    std::int64_t modes_per_shift, int teams) {
  // The number is unknown for a search by frequency; the modes of one slice are assumed.
  if (modes == 0) modes = modes_per_shift;
  // A Lanczos basis grows to about three vectors per mode.
  const auto column = static_cast<double>(local_rows) * sizeof(double) / (1 << 20);
  const double basis = 3.2 * static_cast<double>(std::min(modes, modes_per_shift)) * column;
  return factor.expected_mib() + basis + 2 * static_cast<double>(modes) / teams * column;
}

Probe end_of_search(const parallel::Teams& teams, const Operators& operators, Factorisation& factor,
                    const Request& request) {
  return Searcher(teams, operators, factor, request, Checkpoint(), {}).find_end();
}

Search search(const parallel::Teams& teams, const Operators& operators, Factorisation& factor,
              const Request& request, const Checkpoint& checkpoint, const Progress& progress) {
  return Searcher(teams, operators, factor, request, checkpoint, progress).run();
}

}  // namespace ricochet::modes
