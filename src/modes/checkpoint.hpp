// SPDX-License-Identifier: BSD-2-Clause
// Finished slices on disk, so that a killed search goes on where it was, on any number of ranks.
#pragma once

#include <filesystem>
#include <optional>

#include "src/modes/operators.hpp"
#include "src/modes/slicing.hpp"
#include "src/parallel/teams.hpp"

namespace ricochet::modes {

/// A folder with `plan.h5`, where the search ends and its tasks, and a file for each slice that is done.
/// Files are written beside their names, synced and renamed: what is there is whole. Files that can't be read
/// count as not there.
class Checkpoint {
 public:
  struct Plan {
    Probe end;
    std::vector<Task> tasks;
  };
  struct Found {
    Slice slice;
    int team = 0;           ///< who holds the shapes
    Eigen::MatrixXd shape;  ///< (local rows, Slice::lambda.size()) on that team's ranks, else empty
  };

  /// @param folder  empty: nothing is kept
  Checkpoint(const parallel::Teams& teams, const Operators& operators, std::filesystem::path folder);

  /// Collective on all ranks. Throw InputError, on every rank, when the folder can't be written.
  void save(const Plan& plan) const;
  std::optional<Plan> plan() const;

  /// One slice of this team. Collective on the team; throws InputError on its ranks.
  void save(const Slice& slice, const Eigen::MatrixXd& shape) const;
  /// All slices there are, shared out among the teams, by shift. Collective on all ranks.
  std::vector<Found> slices() const;

 private:
  const parallel::Teams& teams_;
  const Operators& operators_;
  std::filesystem::path folder_;
};

}  // namespace ricochet::modes
