// SPDX-License-Identifier: BSD-2-Clause
#include "src/kernel/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/memory.hpp"
#include "src/mesh/gmsh_session.hpp"
#include "src/modes/eps_solve.hpp"
#include "src/modes/search.hpp"
#include "src/parallel/memory.hpp"

namespace ricochet::kernel {

namespace {

constexpr int most_ranks = 1024;

/// Ranks that share factors need more than their part of the memory, for contributions to fronts.
constexpr double shared_factors = 1.2;

/// Blocks of responses from which a contact-adapted basis usually consists.
constexpr double blocks_of_basis = 6;

/// The time limit of a job relative to the plan, because machines differ.
constexpr double time_limit = 2;

modes::Pace faster(modes::Pace pace, double gain) {
  pace.factor /= gain;
  pace.vector /= gain;
  pace.pair /= gain;
  return pace;  // one rank solves projected problems
}

/// Time of what follows the modes: their residuals and products, and the residual flexibility [s].
double tail_seconds(const scene::KernelRequest& request, const Discretised& made, const modes::Pace& pace,
                    std::int64_t modes, int teams) {
  const auto n = static_cast<double>(modes);
  double sum = (pace.vector * n + pace.pair * n * n / 2) / teams;
  if (has_flexibility(request, made))
    sum += pace.factor + pace.vector * static_cast<double>(made.pressed.cols()) / teams;
  return sum;
}

/// Time of a contact-adapted basis, which all ranks compute together [s].
double basis_seconds(const Discretised& made, const modes::Pace& pace) {
  const double vectors = blocks_of_basis * static_cast<double>(made.pressed.cols() + 3);
  return 2 * pace.factor + pace.vector * vectors + pace.pair * vectors * vectors / 2;
}

/// A word of a command for the shell.
std::string for_shell(const std::string& word) {
  const auto plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) ||
           std::string("_-./=:,+%@").find(c) != std::string::npos;
  };
  if (!word.empty() && std::ranges::all_of(word, plain)) return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string hours_of(double seconds) {
  const auto minutes = static_cast<std::int64_t>(std::ceil(std::max(seconds / 60, 5.0)));
  return fmt::format("{:02}:{:02}:00", minutes / 60, minutes % 60);
}

}  // namespace

KernelPlan plan_kernel(scene::KernelRequest request, OpenedMeshes& meshes, MPI_Comm comm,
                       console::Console& console) {
  const mesh::GmshSession gmsh;
  const double start = console::now(),
               empty_mib = parallel::largest(comm, base::resident_bytes() / base::mib);
  const Discretised made = discretise(request, 0, meshes, comm, console);
  modes::refuse_more_than_there_are(request.modes.count, made.matrices);
  const double prepared = parallel::largest(comm, console::now() - start);
  console.begin(request.body.name + ": measured work");
  const scene::Modes& wanted = request.modes;
  const bool fitted = wanted.basis == scene::Basis::contact;
  const modes::Operators operators(made.mesh, made.matrices);
  modes::Request search = modes::request_of(made.matrices, {.up_to = wanted.up_to,
                                                            .count = fitted ? std::nullopt : wanted.count,
                                                            .modes_per_shift = made.modes_per_shift});
  const modes::SearchPlan plan = modes::plan_search(*made.teams, operators, *made.factor, search);
  KernelPlan out{.body = request.body.name,
                 .unknowns = made.matrices.total_rows,
                 .modes = fitted ? wanted.count.value_or(0) : plan.end.below,
                 .pace = plan.pace,
                 .on_ranks = {}};
  console.end();
  const double room = made.resident_mib + parallel::available_mib(comm) * parallel::size_of(comm);
  const int measured_on = parallel::size_of(comm) / made.teams->count();
  for (int ranks = 1; ranks <= most_ranks; ranks *= 2) {
    RankPlan on{.ranks = ranks};
    for (int shared = fitted ? ranks : 1; shared <= ranks; shared *= 2) {
      on.teams = ranks / shared;
      const double part = static_cast<double>(measured_on) / shared,
                   held = (made.resident_mib - empty_mib) * part,
                   searched = (needed_mib(request, made, out.modes, on.teams, comm) - made.resident_mib) *
                              part * (shared > measured_on ? shared_factors : 1);
      on.mib = empty_mib + held + searched;
      if (on.mib <= usable * room) break;
    }
    const double gain = std::sqrt(static_cast<double>(ranks / on.teams) / measured_on);
    const modes::Pace pace = faster(plan.pace, gain);
    on.seconds = prepared + pace.factor + tail_seconds(request, made, pace, out.modes, on.teams);
    if (fitted || wanted.flexibility_error) on.seconds += basis_seconds(made, pace);
    if (!fitted && plan.dense) {
      on.slices = 1;
      on.seconds += modes::expected_dense_seconds(pace, out.unknowns);
    } else if (!fitted) {
      // On these ranks, the search would use the factors at hand.
      const auto tasks =
          ranks == parallel::size_of(comm) && on.teams == made.teams->count()
              ? plan.task
              : modes::in_order(
                    modes::plan_shifts(plan.model, plan.end.sigma, made.modes_per_shift, on.teams), on.teams);
      on.slices = std::ssize(tasks);
      on.seconds += modes::expected_seconds(pace, plan.model, tasks, on.teams);
    }
    out.on_ranks.push_back(on);
  }
  return out;
}

std::string plan_text(const std::vector<KernelPlan>& kernels, const std::vector<std::string>& words) {
  std::string text;
  std::vector<RankPlan> all;
  for (const KernelPlan& kernel : kernels) {
    text += fmt::format(
        "{}: {} unknowns, {}; measured: {:.3g} s for a factorisation, {:.3g} ms for a vector\n", kernel.body,
        kernel.unknowns, kernel.modes > 0 ? fmt::format("{} modes", kernel.modes) : "a contact-adapted basis",
        kernel.pace.factor, 1e3 * kernel.pace.vector);
    all.resize(kernel.on_ranks.size());
    for (std::size_t k = 0; k < all.size(); ++k) {
      const RankPlan& one = kernel.on_ranks[k];
      all[k].ranks = one.ranks;
      all[k].teams = std::max(all[k].teams, one.teams);
      all[k].slices += one.slices;
      all[k].mib = std::max(all[k].mib, one.mib);
      all[k].seconds += one.seconds;
    }
  }
  text += fmt::format("{:>6} {:>6} {:>7} {:>12} {:>12} {:>11}\n", "ranks", "teams", "slices", "MiB a rank",
                      "time", "efficiency");
  RankPlan chosen = all.front();
  for (std::size_t k = 0; k < all.size(); ++k) {
    const RankPlan& one = all[k];
    // Rows of ranks that do not help are left out.
    if (k > 2 && one.seconds > 0.95 * all[k - 1].seconds) break;
    const double efficiency = all.front().seconds / (one.seconds * one.ranks);
    if (efficiency >= 0.5) chosen = one;
    text += fmt::format("{:>6} {:>6} {:>7} {:>12.0f} {:>12} {:>11.2f}\n", one.ranks, one.teams, one.slices,
                        one.mib, console::duration_of(one.seconds), efficiency);
  }
  std::string command = fmt::format("ricochet kernel -n {}", chosen.ranks);
  for (const std::string& word : words) command += " " + for_shell(word);
  return text +
         fmt::format("sbatch --ntasks={} --cpus-per-task=1 --mem-per-cpu={:.0f}M --time={} --wrap={}\n",
                     chosen.ranks, 50 * std::ceil(chosen.mib / usable / 50),
                     hours_of(time_limit * chosen.seconds), for_shell(command));
}

}  // namespace ricochet::kernel
