// SPDX-License-Identifier: BSD-2-Clause
// Search for all modes up to an end: inertia counts, slices in rounds over the teams, and repair of gaps.
#pragma once

#include "src/modes/checkpoint.hpp"
#include "src/modes/modes.hpp"
#include "src/modes/pace.hpp"
#include "src/modes/slicing.hpp"

namespace ricochet::modes {

/// All slices, with the shapes of the slices that this team computed.
struct Search {
  std::vector<Slice> slices;  ///< by shift, ascending
  Probe end;                  ///< end of the search
  std::vector<Share> share;   ///< modes that each slice keeps
  std::vector<int> team;      ///< team that holds the shapes
  /// (local rows, Slice::lambda.size()) for this team's slices, otherwise empty
  std::vector<Eigen::MatrixXd> shape;
};

/// Peak memory of the search on this rank, in addition to K and M [MiB]: factors, its share of `modes`
/// shapes, and the Lanczos basis of a slice.
double expected_mib(const Factorisation& factor, std::int64_t local_rows, std::int64_t modes,
                    std::int64_t modes_per_shift, int teams);

/// The end of a set: the number of modes to keep, and the inertia there.
struct Cut {
  std::size_t kept = 0;
  Probe at;
};

/// Cuts a list of eigenvalues after the number wanted, and counts there. Multiple modes are kept whole.
/// Takes a gap further up if the count disagrees with the list, which shows that a mode is missing unless one
/// of three gaps agrees. Returns nothing if the list is too short. Collective on all ranks of `teams`.
/// @param lambda  ascending
/// @param below_zero  number of eigenvalues that are not in the list
std::optional<Cut> cut_of(const parallel::Teams& teams, Factorisation& factor,
                          const std::vector<double>& lambda, std::int64_t wanted, std::int64_t below_zero);

/// Counts the eigenvalues below `request.up_to`, or below a shift with `request.count` eigenvalues and a few
/// more below it. Throws SolverError if there is no such shift. Collective on all ranks.
Probe end_of_search(const parallel::Teams& teams, const Operators& operators, Factorisation& factor,
                    const Request& request);

/// A search that has been planned, but not made.
struct SearchPlan {
  CountModel model;        ///< with the counts of the shifts that were factored
  Probe end;               ///< of a number of modes, with an estimated shift
  bool dense = false;      ///< whether the dense solver takes less time than slices
  std::vector<Task> task;  ///< in the order of work
  Pace pace;
  double seconds = 0;  ///< that the search would still take, with the factors at hand
};

/// Plans a search like `search`, and measures its pace. Collective on all ranks.
SearchPlan plan_search(const parallel::Teams& teams, const Operators& operators, Factorisation& factor,
                       const Request& request);

/// Finds the elastic modes up to `request.up_to`, or at least `request.count` modes in total. The number of
/// modes between neighbouring shifts equals the inertia count. Throws SolverError if this cannot be achieved.
/// Collective on all ranks.
Search search(const parallel::Teams& teams, const Operators& operators, Factorisation& factor,
              const Request& request, const Checkpoint& checkpoint, const Progress& progress);

}  // namespace ricochet::modes
