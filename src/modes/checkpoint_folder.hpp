// SPDX-License-Identifier: BSD-2-Clause
// Stores finished slices on disk, so that an interrupted search can resume on any number of ranks.
#pragma once

#include <filesystem>

#include "src/modes/checkpoint.hpp"
#include "src/parallel/teams.hpp"

namespace ricochet::modes {

/// A folder with `plan.h5`, which holds the end of the search and its tasks, and one file for each finished
/// slice. Files are written under temporary names, synced and renamed, so that every file is complete.
/// Unreadable files are ignored.
class CheckpointFolder final : public Checkpoint {
 public:
  /// @param folder  if empty, nothing is stored
  CheckpointFolder(const parallel::Teams& teams, const Operators& operators, std::filesystem::path folder);

  void save(const Plan& plan) const override;
  std::optional<Plan> plan() const override;
  void save(const Slice& slice, const Eigen::MatrixXd& shape) const override;
  std::vector<Found> slices() const override;

 private:
  const parallel::Teams& teams_;
  const Operators& operators_;
  std::filesystem::path folder_;
};

}  // namespace ricochet::modes
