// SPDX-License-Identifier: BSD-2-Clause
// Products of a symmetric block matrix with many columns at once.
#pragma once

#include <petscsf.h>

#include <Eigen/Dense>

#include "src/parallel/parallel.hpp"

namespace ricochet::modes {

/// A symmetric matrix (SBAIJ) ready to multiply blocks of columns.
///
/// Its entries are copied once (of a mass matrix, whose blocks are diagonal, these alone) and used on 8
/// columns at a time: a product then reads the matrix once for all of them, and ranks exchange what they
/// share once.
class BlockProduct {
 public:
  /// Collective on the matrix's ranks.
  explicit BlockProduct(Mat matrix);

  /// A X. @param columns (local rows, n), @return likewise. Collective.
  Eigen::MatrixXd operator()(const Eigen::Ref<const Eigen::MatrixXd>& columns) const;

 private:
  void take_blocks(Mat matrix);
  void number_ghosts(MPI_Comm comm, Mat matrix);
  void take_diagonals();

  bool diagonal_ = false, several_ = false;  ///< several ranks
  PetscInt block_ = 1;
  std::size_t rows_ = 0, ghosts_ = 0;  ///< block rows of this rank, and of others that it meets
  /// Per block row, of the upper triangle; where blocks are diagonal, whole but for ghosts. Columns are
  /// numbered own rows first, ghosts behind.
  std::vector<PetscInt> start_, column_;
  std::vector<double> value_;                           ///< blocks column-major, or their diagonals
  parallel::Handle<PetscSF, PetscSFDestroy> exchange_;  ///< from owners (roots) to ghosts (leaves)
  parallel::RowType row_;                               ///< of a block row of 8 columns
};

}  // namespace ricochet::modes
