// SPDX-License-Identifier: BSD-2-Clause
// The time that a search for modes takes, from a little of its work that is measured.
#pragma once

#include <chrono>

#include "src/modes/slicing.hpp"

namespace ricochet::modes {

/// What the parts of a search take on the ranks of one team [s].
struct Pace {
  double factor = 0;     ///< one factorisation
  double vector = 0;     ///< one Lanczos vector: a solve and two products by M
  double pair = 0;       ///< orthogonalisation of one vector against another one
  double projected = 0;  ///< the eigenpairs of a projected problem, divided by the cube of its size
};

/// Time that a task takes on the slowest rank [s]. Collective.
template <class Task>
double seconds_of(MPI_Comm comm, const Task& task) {
  const auto start = std::chrono::steady_clock::now();
  task();
  return parallel::largest(comm,
                           std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
}

/// Measures one block of Lanczos vectors, their orthogonalisation and a small projected problem. `factor`
/// holds factors, which took `factor_seconds`. The slowest rank counts. Collective on the team.
Pace measure(const Operators& operators, Factorisation& factor, double factor_seconds);

/// The time that is left once the first counts are known [s]: that of slices in this order, which the teams
/// process in rounds. Each round needs a factorisation; a search for a number of modes has the first one
/// already, but needs one for the count at its end.
double expected_seconds(const Pace& pace, const CountModel& model, const std::vector<Task>& tasks, int teams);

/// The time in which the dense solver finds all modes of a body with this number of unknowns [s].
double expected_dense_seconds(const Pace& pace, std::int64_t rows);

}  // namespace ricochet::modes
