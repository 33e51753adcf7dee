// SPDX-License-Identifier: BSD-2-Clause
// Teams of ranks, equal in size, that work on different parts of a problem.
#pragma once

#include "src/parallel/parallel.hpp"

namespace ricochet::parallel {

/// Divides the ranks of a communicator into `count` teams of consecutive ranks. Each team holds a complete
/// body, which is distributed over its ranks in the same way in every team. Ranks with the same position in
/// their teams are peers; they hold the same rows.
class Teams {
 public:
  /// Collective. `count` must divide the number of ranks.
  Teams(MPI_Comm world, int count);
  ~Teams();
  Teams(const Teams&) = delete;
  Teams& operator=(const Teams&) = delete;

  MPI_Comm world() const { return world_; }
  MPI_Comm team() const { return team_; }
  MPI_Comm peers() const { return peers_; }
  int count() const { return count_; }
  int mine() const { return mine_; }  ///< number of this rank's team

  /// Divides `columns` evenly among the teams. Returns the first column of this team and the number of its
  /// columns.
  std::pair<std::ptrdiff_t, std::ptrdiff_t> share(std::ptrdiff_t columns) const {
    const std::ptrdiff_t first = columns * mine_ / count_;
    return {first, columns * (mine_ + 1) / count_ - first};
  }

 private:
  MPI_Comm world_, team_ = MPI_COMM_NULL, peers_ = MPI_COMM_NULL;
  int count_, mine_;
};

}  // namespace ricochet::parallel
