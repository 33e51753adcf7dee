// SPDX-License-Identifier: BSD-2-Clause
// Time of one solve of the complementarity problem of a time step. A quarter of the points are in contact.
//
//   hold     the same points press in every step
//   drift    the pressed zone moves: a point enters or leaves in every fourth step
//   flat     a quarter of the points come into contact in one step, from an empty active set
//
// For real time at 44.1 kHz, a step must not exceed 22.7 µs.
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "contact/complementarity/complementarity.hpp"

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using namespace ricochet;
using namespace ricochet::contact;

MatrixXd flexibility(Index n) {
  return MatrixXd::NullaryExpr(
      n, n, [](Index i, Index j) { return std::exp(-0.2 * static_cast<double>(std::abs(i - j))); });
}

/// Right-hand sides: parabolas that are positive on a quarter of the points and, at each end, on about the
/// range of the flexibility. Their centre starts in the middle and oscillates by `swing` times n.
std::vector<VectorXd> pushes(Index n, double swing) {
  std::vector<VectorXd> out;
  const double points = static_cast<double>(n), half = points / 8 + 4, moves = 4 * swing * points;
  const int steps = std::max(64, static_cast<int>(8 * moves));
  for (int k = 0; k < steps; ++k) {
    const double phase = 2 * M_PI * k / steps, middle = points * (0.5 + swing * std::sin(phase));
    out.push_back(VectorXd::NullaryExpr(n, [&](Index i) {
      const double x = (static_cast<double>(i) - middle) / half;
      return (1 - x * x) * (1 + 0.1 * std::cos(phase));
    }));
  }
  return out;
}

void run(benchmark::State& state, double swing, bool forget) {
  const Index n = state.range(0);
  const MatrixXd S = flexibility(n);
  const std::vector<VectorXd> r = pushes(n, swing);
  ComplementaritySolver solver(static_cast<int>(n), {.same_matrix = true});
  VectorXd lambda(n);
  std::size_t k = 0;
  double active = 0;
  for (auto _ : state) {
    if (forget) solver.reset();
    if (solver.solve(S, r[k], lambda) != SolveStatus::solved) state.SkipWithError("not solved");
    benchmark::DoNotOptimize(lambda.data());
    k = k + 1 < r.size() ? k + 1 : 0;
  }
  active = static_cast<double>((lambda.array() > 0).count());
  const auto& s = solver.statistics();
  state.counters["active"] = active;
  state.counters["pivots"] = static_cast<double>(s.pivots) / static_cast<double>(s.problems);
  state.counters["warm"] = static_cast<double>(s.warm_hits) / static_cast<double>(s.problems);
}

BENCHMARK_CAPTURE(run, hold, 0.0, false)->Arg(40)->Arg(150)->Arg(1000)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(run, drift, 0.2, false)->Arg(40)->Arg(150)->Arg(1000)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(run, flat, 0.0, true)->Arg(40)->Arg(150)->Arg(1000)->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
