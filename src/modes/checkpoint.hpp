// SPDX-License-Identifier: BSD-2-Clause
// What a search stores of its progress, so that it can resume.
#pragma once

#include <optional>

#include "src/modes/slicing.hpp"

namespace ricochet::modes {

/// Keeps the end of a search with its tasks, and its finished slices. This one keeps nothing.
class Checkpoint {
 public:
  struct Plan {
    Probe end;
    std::vector<Task> tasks;
  };
  struct Found {
    Slice slice;
    int team = 0;           ///< team that holds the shapes
    Eigen::MatrixXd shape;  ///< (local rows, Slice::lambda.size()) on that team's ranks, otherwise empty
  };

  virtual ~Checkpoint() = default;

  /// Stores the plan. Collective on all ranks; throws InputError on every rank if it cannot be written.
  virtual void save(const Plan&) const {}
  /// Returns the stored plan, if there is a valid one. Collective on all ranks.
  virtual std::optional<Plan> plan() const { return {}; }

  /// Stores one slice of this team. Collective on the team; throws InputError on its ranks.
  virtual void save(const Slice&, const Eigen::MatrixXd&) const {}
  /// Returns all stored slices, sorted by shift and distributed among the teams. Collective on all ranks.
  virtual std::vector<Found> slices() const { return {}; }
};

}  // namespace ricochet::modes
