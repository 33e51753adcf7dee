// SPDX-License-Identifier: BSD-2-Clause
// K and M of any type of PETSc, copied into the form of the engine.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "src/parallel/teams.hpp"

namespace ricochet::modes {

/// K − aM and M as SBAIJ with one pattern. Blocks have the size of those of the given matrices if it is 3,
/// and 1 otherwise.
struct Pair {
  parallel::Matrix stiffness, mass;
  /// Number of rows of this rank.
  Eigen::Index rows() const;
};

/// Copies the upper triangles to every team. Collective on all ranks of `teams`, which are those of the
/// matrices. Throws SolverError if a matrix cannot be converted to AIJ.
/// @param stiffness, mass  symmetric; no mass stands for the identity
/// @param origin  a
Pair paired(const parallel::Teams& teams, Mat stiffness, Mat mass, double origin);

/// The distribution of rows over all ranks, and over the ranks of each team.
class TeamRows {
 public:
  /// @param given  a matrix on all ranks
  /// @param of_team  its copy on this team
  TeamRows(const parallel::Teams& teams, Mat given, Mat of_team);

  /// Distributes columns over the ranks of every team. Collective on all ranks.
  /// @param columns  (rows of this rank, n)
  /// @return (rows of this rank in its team, n)
  Eigen::MatrixXd to_team(const Eigen::MatrixXd& columns) const;

  /// Distributes columns of which each team has some over all ranks. Collective on all ranks.
  /// @param mine   (rows of this rank in its team, m)
  /// @param index  (m) numbers of these columns among all
  /// @param all    number of all columns
  /// @return (rows of this rank, all)
  Eigen::MatrixXd to_all(const Eigen::MatrixXd& mine, const std::vector<Eigen::Index>& index,
                         Eigen::Index all) const;

 private:
  const parallel::Teams& teams_;
  std::vector<PetscInt> given_, of_team_;  ///< first row of each rank, and after the last
};

}  // namespace ricochet::modes
