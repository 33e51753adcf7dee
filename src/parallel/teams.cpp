// SPDX-License-Identifier: BSD-2-Clause
#include "src/parallel/teams.hpp"

namespace ricochet::parallel {

Teams::Teams(MPI_Comm world, int count) : world_(world), count_(count) {
  const int ranks = size_of(world), rank = rank_of(world);
  if (count < 1 || ranks % count != 0) throw SolverError("internal: teams of unequal size");
  const int size = ranks / count;
  mine_ = rank / size;
  MPI_Comm_split(world, mine_, rank, &team_);
  MPI_Comm_split(world, rank % size, rank, &peers_);
}

Teams::~Teams() {
  MPI_Comm_free(&team_);
  MPI_Comm_free(&peers_);
}

}  // namespace ricochet::parallel
