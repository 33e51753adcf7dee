// SPDX-License-Identifier: BSD-2-Clause
// Contact problems with friction as files of FCLIB, the time that the library needs to solve them cold, and
// that of steps of a box that slides on its face.
//
//   bench_friction write FOLDER NX NY MODES MU STEPS EVERY    problems of two plates that rub on each other
//   bench_friction solve FILE REPEATS                         one line of JSON: seconds of each solve, and r
//   bench_friction slide KERNEL MU SPEED RATE STEPS           one line of JSON: processor seconds of each
//   step
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <cstdio>
#include <ctime>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/hdf5_reader.hpp"
#include "benchmarks/plates.hpp"
#include "contact/api/scene_model.hpp"
#include "contact/complementarity/friction_solver.hpp"
#include "contact/files/fclib.hpp"
#include "contact/stepping/run_steps.hpp"
#include "kernels/read.hpp"

namespace {

using namespace ricochet;
using Clock = std::chrono::steady_clock;

template <class Number>
Number number(const char* text) {
  return static_cast<Number>(std::stod(text));
}

/// The upper plate falls on the lower one, at 44.1 kHz.
void write(const std::string& folder, int nx, int ny, int modes, double friction, int steps, int every) {
  const contact::Model model = benchmarks::plates(nx, ny, modes, 20, friction);
  const StepOptions options{.step = 1.0 / 44100, .block = 1};
  contact::ProblemFiles files(model, options,
                              {.folder = folder, .name = "plates", .title = "Plates", .every = every});
  const auto stepper = contact::make_stepper(model, options);
  for (int k = 0; k < steps; ++k) {
    if (stepper->step() != StepStatus::ok) throw std::runtime_error("a step failed");
    files.observe(*stepper);
  }
}

void solve(const std::string& path, int repeats) {
  const base::hdf5::Reader file(path, "");
  const auto n = static_cast<Eigen::Index>(file.read<std::int64_t>("/fclib_local/W/m", {1})[0]);
  const auto count = static_cast<std::size_t>(file.read<std::int64_t>("/fclib_local/W/nzmax", {1})[0]);
  const auto start = file.read<std::int64_t>("/fclib_local/W/p", {static_cast<std::size_t>(n) + 1});
  const auto column = file.read<std::int64_t>("/fclib_local/W/i", {count});
  const auto value = file.read<double>("/fclib_local/W/x", {count});
  const auto q = file.read<double>("/fclib_local/vectors/q", {static_cast<std::size_t>(n)});
  const auto mu = file.read<double>("/fclib_local/vectors/mu", {static_cast<std::size_t>(n / 3)});
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (auto k = start[i]; k < start[i + 1]; ++k) S(i, column[k]) = value[k];
  const Eigen::VectorXd r = -Eigen::Map<const Eigen::VectorXd>(q.data(), n);
  std::vector<contact::FrictionContact> contacts;
  for (int i = 0; i < n / 3; ++i) contacts.push_back({3 * i, 3 * i + 1, mu[i]});

  contact::FrictionSolver solver(static_cast<int>(n));
  Eigen::VectorXd p(n);
  std::vector<double> seconds;
  for (int k = 0; k < repeats; ++k) {
    solver.reset();
    p.setZero();
    const auto begin = Clock::now();
    const contact::SolveStatus status = solver.solve(S, r, contacts, p);
    seconds.push_back(std::chrono::duration<double>(Clock::now() - begin).count());
    if (status != contact::SolveStatus::solved) throw std::runtime_error("not solved");
  }
  fmt::print("{{\"seconds\": [{}], \"r\": [{}]}}\n", fmt::join(seconds, ", "), fmt::join(p, ", "));
}

double processor_seconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// A body slides on the floor under its weight.
void slide(const std::string& path, double friction, double speed, double rate, int steps) {
  Scene scene;
  scene.bodies = {{.name = "box",
                   .kernel = std::make_shared<const kernels::Kernel>(kernels::read(path)),
                   .velocity = {speed, 0.3 * speed, 0}}};
  scene.obstacles = {{.name = "floor", .normal = {0, 0, 1}}};
  scene.pairs = {{.a = "box", .b = "floor", .gap = 0, .friction = Friction{friction, friction, 0}}};
  scene.gravity = {0, 0, -9.81};
  const contact::Model model = model_of(scene);
  const auto stepper = contact::make_stepper(model, {.step = 1 / rate, .block = 1});
  std::vector<double> seconds;
  double touching = 0;
  for (int k = 0; k < steps; ++k) {
    const double begin = processor_seconds();
    if (stepper->step() != StepStatus::ok) throw std::runtime_error("a step failed");
    seconds.push_back(processor_seconds() - begin);
    touching += stepper->active();
  }
  const contact::SolveStatistics work = stepper->solver();
  fmt::print("{{\"touching\": {}, \"renewals\": {}, \"fallbacks\": {}, \"seconds\": [{}]}}\n",
             touching / steps, work.renewals, work.fallbacks, fmt::join(seconds, ", "));
}

}  // namespace

int main(int argc, char** argv) try {
  const std::string what = argc > 1 ? argv[1] : "";
  if (what == "write" && argc == 9)
    write(argv[2], number<int>(argv[3]), number<int>(argv[4]), number<int>(argv[5]), number<double>(argv[6]),
          number<int>(argv[7]), number<int>(argv[8]));
  else if (what == "solve" && argc == 4)
    solve(argv[2], number<int>(argv[3]));
  else if (what == "slide" && argc == 7)
    slide(argv[2], number<double>(argv[3]), number<double>(argv[4]), number<double>(argv[5]),
          number<int>(argv[6]));
  else
    throw std::runtime_error(
        "write FOLDER NX NY MODES MU STEPS EVERY, solve FILE REPEATS, or slide KERNEL MU SPEED RATE STEPS");
} catch (const std::exception& error) {
  fmt::print(stderr, "bench_friction: {}\n", error.what());
  return 2;
}
