// SPDX-License-Identifier: BSD-2-Clause
// Products of a symmetric block matrix with many columns.
#pragma once

#include <petscsf.h>

#include <Eigen/Dense>

#include "src/parallel/parallel.hpp"

namespace ricochet::modes {

/// A symmetric matrix (SBAIJ), prepared to multiply blocks of columns.
///
/// Its entries are copied once and applied to 8 columns at a time. A product thus reads the matrix once for
/// all 8, and ranks exchange shared rows once. If the blocks are diagonal, as in a mass matrix, only their
/// diagonals are copied. Rows are reordered by breadth-first search (Cuthill & McKee 1969), so that the rows
/// that a row refers to are still in cache.
class BlockProduct {
 public:
  /// Collective on the matrix's ranks.
  explicit BlockProduct(Mat matrix);

  /// Returns A X (local rows, n). Collective.
  /// @param columns  X (local rows, n)
  Eigen::MatrixXd operator()(const Eigen::Ref<const Eigen::MatrixXd>& columns) const;

 private:
  void take_blocks(Mat matrix);
  std::vector<PetscInt> number_ghosts(const PetscInt* range, int rank);
  void reorder();
  void connect(MPI_Comm comm, const PetscInt* range, const std::vector<PetscInt>& ghost);
  void take_diagonals();

  bool diagonal_ = false, several_ = false;  ///< whether blocks are diagonal; whether there are several ranks
  PetscInt block_ = 1;
  /// Number of block rows of this rank, and of ghosts: rows of other ranks that it uses.
  std::size_t rows_ = 0, ghosts_ = 0;
  std::vector<PetscInt> place_;  ///< place of each block row in the order of the copy
  /// The upper triangle by block rows in that order; with diagonal blocks, complete rows, except for the rows
  /// of ghosts. Columns are numbered with own rows first, then ghosts.
  std::vector<PetscInt> start_, column_;
  std::vector<double> value_;                           ///< blocks column-major, or their diagonals
  parallel::Handle<PetscSF, PetscSFDestroy> exchange_;  ///< from owners (roots) to ghosts (leaves)
  parallel::RowType row_;                               ///< a block row of 8 columns
};

}  // namespace ricochet::modes
