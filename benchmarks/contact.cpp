// SPDX-License-Identifier: BSD-2-Clause
// Speed of contact stepping on one core, as a multiple of real time at 44.1 kHz, and the times of the slowest
// steps.
//
//   bench_contact [--benchmark_…]      look-ahead blocks against single steps
//   bench_contact --worst [STEPS]      percentiles of the time of a step and of a block of 64 steps
//   bench_contact --least [NAME]       least and median CPU times of 48 steps, comparable while other
//                                      programs run; of scenes whose name contains NAME
//   bench_contact --turning [ROUNDS [PART]]   bodies that turn: steps and flight; scenes named like PART
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <map>
#include <memory>
#include <string_view>
#include <vector>

#include "benchmarks/lattice.hpp"
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
  auto stepper =
      contact::make_stepper(model_of(size, friction), {.contact = {.scheme = ricochet::Scheme::compliant},
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

/// CPU time of the thread [µs].
double now() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e6 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_nsec);
}

/// CPU times of groups of steps. A group that no other program interrupts finds its data in the caches.
void least(std::string_view part) {
  fmt::print("| scene | touching | us a step: least | median | x real time |\n|---|---|---|---|---|\n");
  constexpr int length = 48;  // whole blocks
  for (const Size& size : sizes)
    for (const double friction : frictions)
      for (const Variant& variant : variants) {
        const std::string name = name_of(size, friction, variant);
        if (name.find(part) == std::string::npos) continue;
        const std::unique_ptr<Stepper> stepper = settled(size, friction, variant);
        std::vector<double> times(size.nx * size.ny < 1000 ? 5000 : 1500);
        for (double& time : times) {
          const double start = now();
          for (int l = 0; l < length; ++l)
            if (stepper->step() != ricochet::StepStatus::ok) std::abort();
          time = (now() - start) / length;
        }
        std::sort(times.begin(), times.end());
        fmt::print("| {} | {} | {:.2f} | {:.2f} | {:.2f} |\n", name, stepper->active(), times.front(),
                   times[times.size() / 2], 1e6 / rate / times.front());
        std::fflush(stdout);
      }
}

/// Bodies that turn, from a state of a scene on.
struct TurningScene {
  std::string name;
  std::vector<kernels::Kernel> kernels{};
  contact::Model model{};
  std::unique_ptr<Stepper> stepper{};
  int warm = 0, steps = 0;  ///< before the measurement; of a round
};

StepOptions turning_options(int steps_per_sample) {
  return {.contact = {.scheme = ricochet::Scheme::compliant},
          .rigid = {.rotation = ricochet::Rotation::finite},
          .step = 1 / rate,
          .steps_per_sample = steps_per_sample,
          .block = 1};
}

/// Two boxes that are pressed on each other and spin in opposite senses. The lower one has no candidate below
/// the upper one, all of whose lowest candidates touch.
TurningScene pressed(int touching) {
  TurningScene out{.name = fmt::format("two bodies, {} points", touching), .warm = 500, .steps = 1000};
  const std::array<int, 3> count = touching == 40   ? std::array{8, 5, 4}
                                   : touching == 20 ? std::array{5, 4, 6}
                                                    : std::array{5, 2, 11};
  const benchmarks::Lattice upper{.count = count, .spacing = {0.01, 0.01, 0.01}},
      lower{.count = {4, 4, 7}, .spacing = {0.1, 0.1, 0.01}};
  out.kernels = {benchmarks::kernel_of(upper), benchmarks::kernel_of(lower)};
  std::vector<contact::PlacedBody> bodies(2);
  for (std::size_t k = 0; k < 2; ++k) bodies[k].kernel = &out.kernels[k];
  bodies[0].translation = {0, 0, 0.5 * 0.01 * (count[2] - 1) + 0.03};
  bodies[0].angular_velocity = {0, 0, 20};
  bodies[1].angular_velocity = {0, 0, -1};
  out.model = benchmarks::all_meet(bodies, 0.3, false, 0);
  out.stepper = contact::make_stepper(out.model, turning_options(1));
  const double force = 20 * 9.81 * out.kernels[0].mass;
  out.stepper->push(0, {0, 0, -force}, {0, 0, 0});
  out.stepper->push(1, {0, 0, force}, {0, 0, 0});
  return out;
}

enum class Eight { spin, tumble, one_awake };

/// Eight boxes with four feet each over a floor: they spin on it, or fall from above and tumble; or seven
/// sleep, while a torque keeps one awake.
TurningScene eight(Eight motion) {
  const bool tumble = motion == Eight::tumble;
  const auto is_pressed = [&](int k) {
    return motion == Eight::spin || (motion == Eight::one_awake && k == 0);
  };
  TurningScene out{.name = tumble                  ? "eight bodies that tumble"
                           : motion == Eight::spin ? "eight bodies, 4 points each"
                                                   : "the same, seven of them asleep",
                   .warm = tumble                  ? 0
                           : motion == Eight::spin ? 3000
                                                   : 20000,
                   .steps = tumble ? 22050 : 1000};
  const benchmarks::Lattice box{
      .count = {5, 5, 5}, .spacing = {0.01, 0.01, 0.01}, .damping = 0.1, .foot = 1e-3};
  out.kernels = {benchmarks::kernel_of(box)};
  std::vector<contact::PlacedBody> bodies(8);
  for (int k = 0; k < 8; ++k) {
    contact::PlacedBody& body = bodies[static_cast<std::size_t>(k)];
    body.kernel = out.kernels.data();
    body.translation = {0.12 * (k % 4), 0.12 * (k / 4), 0.021 + 1e-5};
    if (is_pressed(k)) body.angular_velocity = {0, 0, 100 + 2.0 * k};
    if (!tumble) continue;
    body.translation.z() += 0.03 + 0.003 * k;
    body.angular_velocity = {40 - 3.0 * k, 20 + 5.0 * k, 10};
  }
  out.model = benchmarks::all_meet(bodies, 0.3, true, 9.81);
  out.stepper = contact::make_stepper(out.model, turning_options(1));
  for (int k = 0; k < 8; ++k)
    if (is_pressed(k))
      out.stepper->push(k, {0, 0, -20 * 9.81 * out.kernels[0].mass},
                        {0, 0, motion == Eight::one_awake ? 1e-9 : 0});
  return out;
}

/// Two boxes that turn far from each other.
TurningScene flying(int steps_per_sample) {
  TurningScene out{.name = fmt::format("1 s of flight, {:.0f} samples", rate / steps_per_sample),
                   .steps = static_cast<int>(rate) / steps_per_sample};
  const benchmarks::Lattice box{.count = {5, 5, 5}, .spacing = {0.01, 0.01, 0.01}};
  out.kernels = {benchmarks::kernel_of(box)};
  std::vector<contact::PlacedBody> bodies(2);
  for (int k = 0; k < 2; ++k) {
    contact::PlacedBody& body = bodies[static_cast<std::size_t>(k)];
    body.kernel = out.kernels.data();
    body.translation = {0.3 * k, 0, 100};
    body.angular_velocity = {10, 20, 30};
  }
  out.model = benchmarks::all_meet(bodies, 0.3, true, 9.81);
  out.stepper = contact::make_stepper(out.model, turning_options(steps_per_sample));
  return out;
}

/// Rounds begin from the same state. Of each step, the least time of all rounds counts: other programs
/// lengthen some.
void turning(int rounds, std::string_view part) {
  fmt::print("| scene | touching | us a step: mean | median | p99 | largest | s a second |\n|{}\n",
             "---|---|---|---|---|---|---|");
  std::vector<TurningScene> scenes;
  for (const int touching : {10, 20, 40}) scenes.push_back(pressed(touching));
  for (const Eight motion : {Eight::spin, Eight::one_awake, Eight::tumble}) scenes.push_back(eight(motion));
  for (const int steps_per_sample : {441, 44100}) scenes.push_back(flying(steps_per_sample));
  for (TurningScene& scene : scenes) {
    if (scene.name.find(part) == std::string::npos) continue;
    for (int k = 0; k < scene.warm; ++k)
      if (scene.stepper->step() != ricochet::StepStatus::ok) std::abort();
    const std::unique_ptr<Stepper> begin = scene.stepper->clone();
    std::vector<double> least(static_cast<std::size_t>(scene.steps), 1e99);
    double touching = 0;
    std::int64_t crossed = 0;
    for (int round = 0; round < rounds; ++round) {
      scene.stepper->assign(*begin);
      for (double& time : least) {
        const double start = now();
        if (scene.stepper->step() != ricochet::StepStatus::ok) std::abort();
        time = std::min(time, now() - start);
        touching += scene.stepper->active();
      }
      crossed = scene.stepper->steps() - begin->steps();
    }
    double sum = 0;
    for (const double time : least) sum += time;
    std::sort(least.begin(), least.end());
    const auto count = static_cast<double>(scene.steps);
    fmt::print("| {} | {:.1f} | {:.2f} | {:.2f} | {:.1f} | {:.1f} | {:.3g} |\n", scene.name,
               touching / count / rounds, sum / count, least[least.size() / 2],
               least[least.size() * 99 / 100], least.back(),
               1e-6 * sum * rate / static_cast<double>(crossed));
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
  if (argc > 1 && std::string_view(argv[1]) == "--least") {
    least(argc > 2 ? argv[2] : "");
    return 0;
  }
  if (argc > 1 && std::string_view(argv[1]) == "--turning") {
    turning(argc > 2 ? std::atoi(argv[2]) : 5, argc > 3 ? argv[3] : "");
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
