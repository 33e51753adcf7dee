// SPDX-License-Identifier: BSD-2-Clause
// Plans the slices of a spectrum with N(λ) ~ λ^P, as the search for modes does for each number of teams:
//
//   bench_plan POWER MODES PER_SHIFT TEAMS...
//
// Prints one line of JSON: for each number of teams, the Lanczos vectors expected in each slice. The slices
// of a team follow each other with a stride of the number of teams. scripts/bench scale simulates runs from
// them.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <cstdlib>
#include <iostream>

#include "src/modes/slicing.hpp"

int main(int argc, char** argv) {
  if (argc < 5) {
    std::cerr << "bench_plan: needs POWER MODES PER_SHIFT TEAMS...\n";
    return 2;
  }
  using namespace ricochet::modes;
  const double power = std::atof(argv[1]), modes = std::atof(argv[2]);
  const CountModel model(0, {}, [&](double lambda) { return modes * std::pow(lambda, power); });
  std::string lists;
  for (int k = 4; k < argc; ++k) {
    std::vector<double> vectors;
    for (const Task& task : plan_shifts(model, 1, std::atoi(argv[3]), std::atoi(argv[k])))
      vectors.push_back(expected_vectors(model, task.wanted));
    lists += fmt::format("{}\"{}\": [{:.1f}]", lists.empty() ? "" : ", ", argv[k], fmt::join(vectors, ", "));
  }
  std::cout << "{" << lists << "}" << std::endl;
}
