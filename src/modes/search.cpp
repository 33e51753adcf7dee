// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "kernels/algebra.hpp"
#include "src/modes/certify.hpp"
#include "src/modes/dense.hpp"

namespace ricochet::modes {

namespace {

/// Relative distance to an eigenvalue below which round-off decides the count at a shift.
constexpr double too_close = 1e-7;

double hertz(double lambda) { return std::sqrt(std::max(lambda, 0.0)) / (2 * std::numbers::pi); }

/// The eigenvalues that the slices keep, ascending.
std::vector<double> lambda_of(const std::vector<Slice>& slices, const std::vector<Share>& share) {
  std::vector<double> lambda;
  for (std::size_t s = 0; s < slices.size(); ++s)
    for (std::size_t k = share[s].first; k < share[s].end; ++k) lambda.push_back(slices[s].lambda[k]);
  std::ranges::sort(lambda);
  return lambda;
}

/// Returns the number of eigenvalues to keep if `wanted` are requested. Multiple ones are kept whole.
std::size_t kept_of(const std::vector<double>& lambda, std::int64_t wanted) {
  auto kept = static_cast<std::size_t>(std::max<std::int64_t>(wanted, 0));
  while (kept > 0 && kept < lambda.size() && lambda[kept] < (1 + kernels::multiple_mode) * lambda[kept - 1])
    ++kept;
  return kept;
}

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
        // No search ends among the modes at zero.
        count_(std::max(request.count.value_or(0), rigid_)),
        factor_(factor),
        checkpoint_(checkpoint),
        expected_(request.expected ? request.expected : operators.expected_count()) {}

  /// Finds the end of the search. Collective.
  Probe find_end() {
    request_.up_to ? probe_up_to(std::pow(static_cast<RadPerSecond>(*request_.up_to).value, 2))
                   : probe_for(count_);
    return end_;
  }

  Search run() {
    std::vector<Task> tasks;
    if (const auto plan = checkpoint_.plan()) {
      end_ = plan->end;
      tasks = resume(plan->tasks);
      progress_.counted(end_.below, std::ssize(tasks), 0);
    } else {
      progress_.begin("inertia counts");
      SearchPlan planned = make_plan();
      tasks = std::move(planned.task);
      checkpoint_.save({end_, tasks});
      progress_.counted(end_.below, std::ssize(tasks), planned.seconds);
    }
    work(tasks);
    if (finish(8)) return std::move(found_);
    if (can_be_dense() && rows() <= most_dense_rows) {
      dense_ = true;
      found_ = {};
      work(dense_task());
      if (finish(0)) return std::move(found_);
    }
    const Interval gap = stitch(rigid_, found_.slices, end_).missing.front().wanted;
    throw SolverError(
        fmt::format("modes: inertia proves modes between {:.6g} and {:.6g} Hz that are not found",
                    hertz(gap.from), hertz(gap.to)));
  }

  /// Chooses the tasks, and measures how much time they will take.
  SearchPlan make_plan() {
    std::vector<Task> tasks = choose_tasks();
    // Teams whose factors were not needed do not measure.
    Pace pace;
    if (factor_seconds_ > 0) pace = measure(operators_, factor_, factor_seconds_);
    for (double* part : {&pace.factor, &pace.vector, &pace.pair, &pace.projected})
      *part = parallel::largest(teams_.world(), *part);
    const double seconds = dense_ ? expected_dense_seconds(pace, rows())
                                  : expected_seconds(pace, model(), tasks, teams_.count());
    return {model(), end_, dense_, std::move(tasks), pace, seconds};
  }

 private:
  std::int64_t rows() const { return operators_.total_rows; }

  /// Whether no eigenvalue below zero is left out; the dense solver needs a definite K − σM at some σ < 0.
  bool can_be_dense() const { return operators_.below_zero == operators_.rigid.cols(); }

  CountModel model() const { return CountModel(rigid_, probes_, expected_); }

  /// The number of elastic modes requested; known once the end has been counted, or by request.
  std::int64_t modes() const { return (request_.count ? count_ : end_.below) - rigid_; }

  /// One more eigenvalue than requested shows where the last one ends. The highest slice goes on until it has
  /// found them all.
  double sought() const { return static_cast<double>(count_) + 1; }

  /// Chooses the solver and its tasks.
  std::vector<Task> choose_tasks() {
    const bool dense_is_possible = request_.solver == Solver::fastest && can_be_dense();
    if (request_.up_to) find_end();
    dense_ = request_.solver == Solver::dense || (dense_is_possible && dense_is_faster(rows(), modes()));
    if (dense_) {
      if (request_.count) find_end();
      return dense_task();
    }
    return request_.up_to ? plan_shifts(model(), end_.sigma, request_.modes_per_shift, teams_.count())
                          : plan_for_count();
  }

  /// The task of all modes, about a shift in their middle.
  std::vector<Task> dense_task() const { return plan_shifts(model(), end_.sigma, end_.below + 1, 1); }

  /// Plans shifts for a number of modes. The end of the search is only estimated. K is factored at the first
  /// shifts of the plan, and their counts correct it. It is then placed about these shifts, whose factors are
  /// the first ones to be used, unless other shifts save more than their factors cost.
  std::vector<Task> plan_for_count() {
    std::vector<Task> tasks;
    for (int round = 0; round < 8; ++round) {
      end_ = {model().lambda_at(sought()), count_};
      tasks = in_order(plan_shifts(model(), end_.sigma, request_.modes_per_shift, teams_.count()),
                       teams_.count());
      std::vector<double> factored;
      for (std::size_t t = 0; t < std::min(tasks.size(), static_cast<std::size_t>(teams_.count())); ++t)
        factored.push_back(tasks[t].sigma);
      factored = probe(factored);
      end_.sigma = model().lambda_at(sought());
      if (const auto plan = plan_about(model(), end_.sigma, request_.modes_per_shift, factored))
        return in_order(*plan, static_cast<int>(factored.size()));
    }
    return tasks;
  }

  /// Completes the search in up to `rounds` further rounds. Returns whether every inertia count agrees.
  bool finish(int rounds) {
    for (int round = 0;; ++round) {
      settle_end();
      Stitched stitched = stitch(rigid_, found_.slices, end_);
      if (stitched.missing.empty()) {
        found_.share = std::move(stitched.share);
        found_.end = end_;
        return true;
      }
      if (round == rounds) return false;
      dense_ = false;
      options_ = other_start(options_);
      work(stitched.missing);
    }
  }

  /// Places the end above the modes requested, clear of modes, and counts there. If too few modes are found,
  /// the search goes on above them.
  void settle_end() {
    if (request_.up_to) return move_end_off_modes();
    for (int round = 0; round < 60; ++round) {
      // The eigenvalues above the last shift are not counted yet.
      const Slice& top = found_.slices.back();
      end_ = {top.covered.to, top.probe.below};
      for (const double lambda : top.lambda)
        if (lambda >= top.probe.sigma && lambda < end_.sigma) ++end_.below;
      const Stitched stitched = stitch(rigid_, found_.slices, end_);
      if (!stitched.missing.empty()) return;
      const std::vector<double> lambda = lambda_of(found_.slices, stitched.share);
      if (const auto cut = cut_of(teams_, factor_, lambda, count_ - rigid_, rigid_)) {
        end_ = cut->at;
        return;
      }
      if (end_.below >= operators_.free_rows) {
        end_ = count_below(teams_, factor_, lambda.empty() ? end_.sigma : 1.001 * lambda.back());
        return;
      }
      probes_.push_back(end_);
      const double to = std::max(model().lambda_at(sought()), 1.05 * end_.sigma);
      const double overlap =
          1.5 * (to - end_.sigma) / std::max(4.0, model().count_at(to) - model().count_at(end_.sigma));
      work({{(end_.sigma + to) / 2, {end_.sigma - overlap, to}}});
    }
    throw SolverError(fmt::format("modes: no frequency with {} modes below it is found", count_));
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
  /// probes. Returns the shifts of the factors, which may have been raised.
  std::vector<double> probe(const std::vector<double>& sigma) {
    std::vector<double> mine;
    if (static_cast<std::size_t>(teams_.mine()) < sigma.size()) {
      factor_seconds_ =
          seconds_of(teams_.team(), [&] { factor_.factor(sigma[static_cast<std::size_t>(teams_.mine())]); });
      mine = {factor_.sigma(), static_cast<double>(factor_.below())};
    }
    std::vector<double> factored;
    for (const auto& probe : from_each_team(mine)) {
      if (probe.empty()) continue;
      probes_.push_back({probe[0], static_cast<std::int64_t>(probe[1])});
      factored.push_back(probe[0]);
    }
    return factored;
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
    // Far above the rigid modes, even if no others are requested.
    const double guess = model().lambda_at(static_cast<double>(rigid_) + wanted);
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
      double next = model().lambda_at(wanted + 0.04 * wanted + 3);
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
    // Modes of different slices are orthogonal only as far as they have converged.
    options_.tolerance = tasks.size() == 1 && found_.slices.empty()
                             ? request_.relative_residual
                             : std::min(request_.relative_residual, 1e-8);
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
          probes_.push_back({m[0], static_cast<std::int64_t>(m[1])});
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

  /// The number of modes that a task must find above its shift, now factored, if it ends the search for a
  /// number of modes; as many as one shift can find.
  std::optional<std::int64_t> above(const Task& task) const {
    if (!request_.count || task.wanted.to <= end_.sigma) return std::nullopt;
    const std::int64_t left = std::max<std::int64_t>(0, count_ - factor_.below()),
                       half = request_.modes_per_shift / 2;
    return left <= 3 * half / 2 ? left : half;
  }

  /// Computes all modes of a task. Raises the shift if it coincides with a mode.
  Converged solve(const Task& task) {
    double sigma = task.sigma;
    const parallel::Progress bar = [&](std::int64_t done, std::int64_t) {
      progress_.at(done, request_.modes_per_shift);
    };
    for (int attempt = 0; attempt < 6; ++attempt) {
      factor_.factor(sigma);
      options_.above = above(task);
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
  std::int64_t
      count_;  ///< number of modes requested, at least those at zero; unless all up to a frequency are
  LanczosOptions options_;
  bool dense_ = false;  ///< whether slices are computed by the dense solver
  Factorisation& factor_;
  const Checkpoint& checkpoint_;
  const ExpectedCount expected_;
  Probe end_;
  std::vector<Probe> probes_;
  Search found_;
  std::size_t done_ = 0, total_ = 0;
  double factor_seconds_ = 0;  ///< of the last count; 0: this team has made none
};

}  // namespace

double expected_mib(const Factorisation& factor, std::int64_t local_rows, std::int64_t modes,
                    std::int64_t modes_per_shift, int teams) {
  const auto column = static_cast<double>(local_rows) * sizeof(double) / (1 << 20);
  const double basis = most_vectors * static_cast<double>(std::min(modes, modes_per_shift)) * column,
               shapes = static_cast<double>(modes) / teams * column;
  return factor.expected_mib() + shapes + basis;
}

Probe end_of_search(const parallel::Teams& teams, const Operators& operators, Factorisation& factor,
                    const Request& request) {
  return Searcher(teams, operators, factor, request, Checkpoint(), {}).find_end();
}

std::optional<Cut> cut_of(const parallel::Teams& teams, Factorisation& factor,
                          const std::vector<double>& lambda, std::int64_t wanted, std::int64_t below_zero) {
  // If residuals may be large, a double mode can look like two, with a gap that does not exist.
  constexpr std::size_t gaps = 3;
  std::optional<Cut> cut;
  const std::size_t first = kept_of(lambda, wanted);
  for (std::size_t kept = first; kept < std::min(lambda.size(), first + gaps); ++kept) {
    const double middle = ((kept > 0 ? lambda[kept - 1] : 0) + lambda[kept]) / 2;
    cut = {kept, count_below(teams, factor, middle)};
    if (cut->at.below == below_zero + static_cast<std::int64_t>(kept)) break;
  }
  return cut;
}

SearchPlan plan_search(const parallel::Teams& teams, const Operators& operators, Factorisation& factor,
                       const Request& request) {
  return Searcher(teams, operators, factor, request, Checkpoint(), {}).make_plan();
}

Search search(const parallel::Teams& teams, const Operators& operators, Factorisation& factor,
              const Request& request, const Checkpoint& checkpoint, const Progress& progress) {
  return Searcher(teams, operators, factor, request, checkpoint, progress).run();
}

}  // namespace ricochet::modes
