// SPDX-License-Identifier: BSD-2-Clause
// The search for all modes up to an end: probes, slices in rounds over the teams, repair.
#pragma once

#include "src/modes/modes.hpp"
#include "src/modes/slicing.hpp"

namespace ricochet::modes {

/// All slices, and the shapes of those that this team worked at.
struct Search {
  std::vector<Slice> slices;  ///< by shift, ascending
  Probe end;                  ///< where the search ended
  std::vector<Share> share;   ///< what each keeps
  std::vector<int> team;      ///< who holds the shapes
  std::vector<Eigen::MatrixXd>
      shape;  ///< (local rows, Slice::lambda.size()) of this team's slices, else empty
};

/// Memory that the search needs on this rank at its peak, beside K and M [MiB]: factors, the basis of an
/// iteration, and its share of `modes` shapes, twice while they are put together.
double expected_mib(const Factorisation& factor, std::int64_t local_rows, std::int64_t modes,
                    std::int64_t modes_per_shift, int teams);

/// Elastic modes up to `request.up_to`, or at least `request.count` of all. Every count between neighbouring
/// shifts agrees with inertia. Throws SolverError where it can't be made to. Collective on all ranks.
Search search(const parallel::Teams& teams, const Operators& operators, Factorisation& factor,
              const Request& request, const Progress& progress);

}  // namespace ricochet::modes
