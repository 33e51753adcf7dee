// SPDX-License-Identifier: BSD-2-Clause
// Speed of contact stepping on one core, as a multiple of real time at 44.1 kHz, and the times of the slowest
// steps.
//
//   bench_contact [--benchmark_…]      look-ahead blocks against single steps
//   bench_contact --worst [STEPS]      percentiles of the time of a step and of a block of 64 steps
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <map>
#include <string_view>

#include "benchmarks/plates.hpp"
#include "contact/stepping/stepper.hpp"
#include "ricochet/denormals.hpp"

namespace {

using namespace ricochet;
using contact::Stepper;
using ricochet::Precision;

constexpr double rate = 44100;

struct Size {
  int nx, ny, modes;
};
constexpr Size sizes[] = {{8, 5, 200}, {15, 10, 500}, {40, 25, 500}};

/// Coefficients of friction; 0 is the frictionless scheme.
constexpr double frictions[] = {0, 0.3};

const contact::Model& model_of(const Size& size, double friction) {
  static std::map<std::pair<int, double>, contact::Model> made;
  const std::pair key(size.nx * size.ny, friction);
  if (!made.contains(key)) made[key] = benchmarks::plates(size.nx, size.ny, size.modes, 20, friction);
  return made[key];
}

struct Variant {
  const char* name;
  int block;
  Precision precision;
  bool every_state;
};
constexpr Variant variants[] = {
    {"single steps", 1, Precision::float64, true},
    {"blocks", 0, Precision::float64, true},
    {"blocks, forces only", 0, Precision::float64, false},
    {"blocks, forces only, single", 0, Precision::float32, false},
};

std::string name_of(const Size& size, double friction, const Variant& variant) {
  return fmt::format("{} points, 2x{} modes{}: {}", size.nx * size.ny, size.modes,
                     friction > 0 ? fmt::format(", friction {}", friction) : "", variant.name);
}

/// A stepper at t = 0.1 s, when the plates have met and stay in contact.
std::unique_ptr<Stepper> settled(const Size& size, double friction, const Variant& variant) {
  auto stepper = contact::make_stepper(model_of(size, friction), {.scheme = ricochet::Scheme::compliant,
                                                                  .step = 1 / rate,
                                                                  .block = variant.block,
                                                                  .precision = variant.precision,
                                                                  .every_state = variant.every_state});
  while (stepper->time() < 0.1)
    if (stepper->step() != ricochet::StepStatus::ok) std::abort();
  return stepper;
}

void stepping(benchmark::State& state, const Size& size, double friction, const Variant& variant) {
  static std::map<std::string, std::unique_ptr<Stepper>> warm;
  const std::string name = name_of(size, friction, variant);
  if (!warm.contains(name)) warm.emplace(name, settled(size, friction, variant));
  Stepper& stepper = *warm.at(name);
  std::int64_t steps = 0, active = 0;
  constexpr int batch = 64;
  for (auto _ : state)
    for (int k = 0; k < batch; ++k) {
      benchmark::DoNotOptimize(stepper.step());
      active += stepper.active();
      ++steps;
    }
  state.counters["x_real_time"] =
      benchmark::Counter(static_cast<double>(steps) / rate, benchmark::Counter::kIsRate);
  state.counters["touching"] = static_cast<double>(active) / static_cast<double>(steps);
}

void worst(std::int64_t steps) {
  using Clock = std::chrono::steady_clock;
  const auto microseconds = [](auto from, auto to) {
    return std::chrono::duration<double, std::micro>(to - from).count();
  };
  fmt::print(
      "| scene | of | median (us) | p99 | p99.9 | largest | budget |\n|---|---|---|---|---|---|---|\n");
  for (const Size& size : sizes)
    for (const double friction : frictions)
      for (const Variant& variant : variants) {
        const std::unique_ptr<Stepper> stepper = settled(size, friction, variant);
        std::vector<double> one, block;
        constexpr int length = 64;
        const std::int64_t count = size.nx * size.ny < 1000 ? steps : steps / 10;
        for (std::int64_t k = 0; k < count; k += length) {
          const auto start = Clock::now();
          auto before = start;
          for (int l = 0; l < length; ++l) {
            if (stepper->step() != ricochet::StepStatus::ok) std::abort();
            const auto now = Clock::now();
            one.push_back(microseconds(before, now));
            before = now;
          }
          block.push_back(microseconds(start, before));
        }
        const auto row = [&](const char* of, std::vector<double>& times, double budget) {
          std::sort(times.begin(), times.end());
          const auto at = [&](double share) {
            return times[std::min(times.size() - 1,
                                  static_cast<std::size_t>(share * static_cast<double>(times.size())))];
          };
          fmt::print("| {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.1f} | {:.1f} |\n",
                     name_of(size, friction, variant), of, at(0.5), at(0.99), at(0.999), times.back(),
                     budget);
        };
        row("step", one, 1e6 / rate);
        row("64 steps", block, length * 1e6 / rate);
        std::fflush(stdout);
      }
}

}  // namespace

int main(int argc, char** argv) {
  const FlushDenormals scope;  // as in Simulation and the player
  if (argc > 1 && std::string_view(argv[1]) == "--worst") {
    worst(argc > 2 ? std::atoll(argv[2]) : 1000000);
    return 0;
  }
  for (const Size& size : sizes)
    for (const double friction : frictions)
      for (const Variant& variant : variants)
        benchmark::RegisterBenchmark(name_of(size, friction, variant).c_str(),
                                     [&size, friction, &variant](benchmark::State& state) {
                                       stepping(state, size, friction, variant);
                                     });
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
