// SPDX-License-Identifier: BSD-2-Clause
// Products of a symmetric block matrix with many columns.
#pragma once

#include <petscsf.h>

#include <Eigen/Dense>

#include "src/parallel/parallel.hpp"

namespace ricochet::modes {

/// A symmetric matrix (SBAIJ), prepared to multiply blocks of columns.
///
/// Its entries are copied once (only the diagonals of the blocks for a mass matrix, whose blocks are
/// diagonal) and applied to 8 columns at a time. A product thus reads the matrix once for all 8, and ranks
/// exchange shared rows once.
class BlockProduct {
 public:
  /// Collective on the matrix's ranks.
  explicit BlockProduct(Mat matrix);

  /// Returns A X. @param columns  X (local rows, n). @return likewise. Collective.
  Eigen::MatrixXd operator()(const Eigen::Ref<const Eigen::MatrixXd>& columns) const;

 private:
  void take_blocks(Mat matrix);
  void number_ghosts(MPI_Comm comm, Mat matrix);
  void take_diagonals();

  bool diagonal_ = false, several_ = false;  ///< blocks are diagonal; several ranks
  PetscInt block_ = 1;
  std::size_t rows_ = 0, ghosts_ = 0;  ///< block rows of this rank, and of others that it shares
  /// Upper triangle by block rows; with diagonal blocks, the complete rows except ghosts. Columns are
  /// numbered: own rows first, then ghosts.
  std::vector<PetscInt> start_, column_;
  std::vector<double> value_;                           ///< blocks column-major, or their diagonals
  parallel::Handle<PetscSF, PetscSFDestroy> exchange_;  ///< from owners (roots) to ghosts (leaves)
  parallel::RowType row_;                               ///< a block row of 8 columns
};

}  // namespace ricochet::modes
