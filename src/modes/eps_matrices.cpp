// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/eps_matrices.hpp"

#include <algorithm>
#include <optional>
#include <vector>

namespace ricochet::modes {

namespace {

using parallel::check;

/// The rows of a matrix, converted to AIJ and copied to each team.
class RedundantRows {
 public:
  RedundantRows(const parallel::Teams& teams, Mat matrix) {
    if (matrix == nullptr) return;
    check(MatConvert(matrix, MATAIJ, MAT_INITIAL_MATRIX, matrix_.out()));
    given_ = true;
    if (teams.count() == 1) return;
    parallel::Matrix copy;
    check(MatCreateRedundantMatrix(matrix_, teams.count(), teams.team(), MAT_INITIAL_MATRIX, copy.out()));
    matrix_ = std::move(copy);
  }
  Mat matrix() const { return matrix_; }
  /// Calls visit(column, value) for the entries of a row; those of the identity if no matrix was given.
  template <class Visit>
  void each(PetscInt row, const Visit& visit) const {
    if (!given_) return visit(row, 1.0);
    PetscInt n = 0;
    const PetscInt* column = nullptr;
    const double* value = nullptr;
    check(MatGetRow(matrix_, row, &n, &column, &value));
    for (PetscInt k = 0; k < n; ++k) visit(column[k], value[k]);
    check(MatRestoreRow(matrix_, row, &n, &column, &value));
  }

 private:
  parallel::Matrix matrix_;
  bool given_ = false;
};

PetscInt block_of(Mat matrix) {
  PetscInt block = 1;
  if (matrix != nullptr) check(MatGetBlockSize(matrix, &block));
  return block;
}

/// Blocks of the upper triangle of K and M in the rows of this rank of the team.
struct Pattern {
  PetscInt block = 1, first = 0, end = 0, total = 0;  ///< size of a block; range and number of the rows
  std::vector<std::vector<PetscInt>> columns{};  ///< block columns of each block row, from the diagonal on

  PetscInt block_row(std::size_t i) const { return first / block + static_cast<PetscInt>(i); }
};

Pattern pattern_of(const RedundantRows& stiffness, const RedundantRows& mass, PetscInt block) {
  Pattern pattern{block};
  check(MatGetOwnershipRange(stiffness.matrix(), &pattern.first, &pattern.end));
  check(MatGetSize(stiffness.matrix(), &pattern.total, nullptr));
  pattern.columns.resize(static_cast<std::size_t>((pattern.end - pattern.first) / block));
  for (std::size_t i = 0; i < pattern.columns.size(); ++i) {
    const PetscInt row = pattern.block_row(i);
    std::vector<PetscInt>& here = pattern.columns[i];
    here.push_back(row);
    for (PetscInt r = row * block; r < (row + 1) * block; ++r)
      for (const RedundantRows* matrix : {&stiffness, &mass})
        matrix->each(r, [&](PetscInt column, double) {
          if (column / block > row) here.push_back(column / block);
        });
    std::ranges::sort(here);
    here.erase(std::unique(here.begin(), here.end()), here.end());
  }
  return pattern;
}

/// Collective on the team.
parallel::Matrix empty_matrix(const Pattern& pattern, MPI_Comm team) {
  const auto& [block, first, end, total, columns] = pattern;
  std::vector<PetscInt> own(columns.size(), 0), of_others(columns.size(), 0);
  for (std::size_t i = 0; i < columns.size(); ++i)
    for (const PetscInt column : columns[i]) ++(column < end / block ? own : of_others)[i];
  parallel::Matrix matrix;
  check(MatCreateSBAIJ(team, block, end - first, end - first, total, total, 0, own.data(), 0,
                       of_others.data(), matrix.out()));
  check(MatSetOption(matrix, MAT_IGNORE_LOWER_TRIANGULAR, PETSC_TRUE));
  return matrix;
}

/// Where the values of one block row contain an entry: row by row, in the order of the block columns. Empty
/// below the diagonal.
/// @param r  row within the block row
std::optional<std::size_t> place_of(PetscInt r, PetscInt column, PetscInt block,
                                    const std::vector<PetscInt>& columns) {
  const auto at = std::ranges::lower_bound(columns, column / block);
  if (at == columns.end() || *at != column / block) return {};
  const auto width = static_cast<std::size_t>(block) * columns.size();
  return static_cast<std::size_t>(r) * width +
         static_cast<std::size_t>((at - columns.begin()) * block + column % block);
}

}  // namespace

Pair paired(const parallel::Teams& teams, Mat given_stiffness, Mat given_mass, double origin) {
  const RedundantRows stiffness(teams, given_stiffness), mass(teams, given_mass);
  const bool blocked = block_of(given_stiffness) == 3 && (given_mass == nullptr || block_of(given_mass) == 3);
  const Pattern pattern = pattern_of(stiffness, mass, blocked ? 3 : 1);
  const PetscInt block = pattern.block;
  Pair pair{empty_matrix(pattern, teams.team()), empty_matrix(pattern, teams.team())};
  std::vector<double> of_stiffness, of_mass;
  for (std::size_t i = 0; i < pattern.columns.size(); ++i) {
    const PetscInt row = pattern.block_row(i);
    const std::vector<PetscInt>& here = pattern.columns[i];
    of_stiffness.assign(static_cast<std::size_t>(block * block) * here.size(), 0);
    of_mass.assign(of_stiffness.size(), 0);
    for (PetscInt r = 0; r < block; ++r) {
      stiffness.each(row * block + r, [&](PetscInt column, double value) {
        if (const auto at = place_of(r, column, block, here)) of_stiffness[*at] += value;
      });
      mass.each(row * block + r, [&](PetscInt column, double value) {
        if (const auto at = place_of(r, column, block, here)) {
          of_mass[*at] += value;
          of_stiffness[*at] -= origin * value;
        }
      });
    }
    const auto n = static_cast<PetscInt>(here.size());
    check(MatSetValuesBlocked(pair.stiffness, 1, &row, n, here.data(), of_stiffness.data(), INSERT_VALUES));
    check(MatSetValuesBlocked(pair.mass, 1, &row, n, here.data(), of_mass.data(), INSERT_VALUES));
  }
  for (Mat matrix : {static_cast<Mat>(pair.stiffness), static_cast<Mat>(pair.mass)}) {
    check(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
  }
  return pair;
}

Eigen::Index Pair::rows() const {
  PetscInt rows = 0;
  check(MatGetLocalSize(stiffness, &rows, nullptr));
  return rows;
}

TeamRows::TeamRows(const parallel::Teams& teams, Mat given, Mat of_team) : teams_(teams) {
  const auto ranges = [](MPI_Comm comm, Mat matrix) {
    const PetscInt* range = nullptr;
    check(MatGetOwnershipRanges(matrix, &range));
    return std::vector<PetscInt>(range, range + parallel::size_of(comm) + 1);
  };
  given_ = ranges(teams.world(), given);
  of_team_ = ranges(teams.team(), of_team);
}

Eigen::MatrixXd TeamRows::to_team(const Eigen::MatrixXd& columns) const {
  const auto rank = static_cast<std::size_t>(parallel::rank_of(teams_.world())),
             in_team = static_cast<std::size_t>(parallel::rank_of(teams_.team()));
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(given_.back(), columns.cols());
  whole.middleRows(given_[rank], columns.rows()) = columns;
  parallel::sum(teams_.world(), whole);
  return whole.middleRows(of_team_[in_team], of_team_[in_team + 1] - of_team_[in_team]);
}

Eigen::MatrixXd TeamRows::to_all(const Eigen::MatrixXd& mine, const std::vector<Eigen::Index>& index,
                                 Eigen::Index all) const {
  constexpr Eigen::Index panel = 64;
  const auto ranks = static_cast<std::size_t>(parallel::size_of(teams_.world())),
             rank = static_cast<std::size_t>(parallel::rank_of(teams_.world())),
             team_size = of_team_.size() - 1;
  // The rows that a rank has in its team, and another one among all.
  const auto common = [&](std::size_t in_team, std::size_t among_all) {
    const PetscInt first = std::max(of_team_[in_team], given_[among_all]),
                   end = std::min(of_team_[in_team + 1], given_[among_all + 1]);
    return std::pair<Eigen::Index, Eigen::Index>(first, std::max<Eigen::Index>(end - first, 0));
  };
  Eigen::MatrixXd columns(given_[rank + 1] - given_[rank], all);
  const auto most =
      static_cast<Eigen::Index>(parallel::largest(teams_.world(), static_cast<double>(mine.cols())));
  for (Eigen::Index from = 0; from < most; from += panel) {
    // A message has the number of each column and then its rows.
    std::vector<std::vector<double>> to(ranks);
    for (std::size_t r = 0; r < ranks; ++r) {
      const auto [first, n] = common(rank % team_size, r);
      const Eigen::Index at = first - of_team_[rank % team_size];
      for (Eigen::Index j = from; n > 0 && j < std::min(from + panel, mine.cols()); ++j) {
        to[r].push_back(static_cast<double>(index[static_cast<std::size_t>(j)]));
        to[r].insert(to[r].end(), mine.col(j).data() + at, mine.col(j).data() + at + n);
      }
    }
    const auto got = parallel::exchange(teams_.world(), to);
    for (std::size_t r = 0; r < ranks; ++r) {
      const auto [first, n] = common(r % team_size, rank);
      const auto step = static_cast<std::size_t>(n) + 1;
      for (std::size_t at = 0; at + step <= got[r].size(); at += step)
        columns.col(static_cast<Eigen::Index>(got[r][at])).segment(first - given_[rank], n) =
            Eigen::Map<const Eigen::VectorXd>(got[r].data() + at + 1, n);
    }
  }
  return columns;
}

}  // namespace ricochet::modes
