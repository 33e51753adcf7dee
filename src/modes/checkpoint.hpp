// SPDX-License-Identifier: BSD-2-Clause
// Stores finished slices on disk, so that an interrupted search can resume on any number of ranks.
#pragma once

#include <filesystem>
#include <optional>

#include "src/modes/operators.hpp"
#include "src/modes/slicing.hpp"
#include "src/parallel/teams.hpp"

namespace ricochet::modes {

/// A folder with `plan.h5`, which holds the end of the search and its tasks, and one file for each finished
/// slice. Files are written under temporary names, synced and renamed, so that every file is complete.
/// Unreadable files are ignored.
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

  /// @param folder  if empty, nothing is stored
  Checkpoint(const parallel::Teams& teams, const Operators& operators, std::filesystem::path folder);

  /// Stores the plan. Collective on all ranks; throws InputError on every rank if the folder cannot be
  /// written.
  void save(const Plan& plan) const;
  /// Returns the stored plan, if there is a valid one. Collective on all ranks.
  std::optional<Plan> plan() const;

  /// Stores one slice of this team. Collective on the team; throws InputError on its ranks.
  void save(const Slice& slice, const Eigen::MatrixXd& shape) const;
  /// Returns all stored slices, sorted by shift and distributed among the teams. Collective on all ranks.
  std::vector<Found> slices() const;

 private:
  const parallel::Teams& teams_;
  const Operators& operators_;
  std::filesystem::path folder_;
};

}  // namespace ricochet::modes
