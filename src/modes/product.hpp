// Products of a symmetric block matrix with many columns at once.
#pragma once

#include <Eigen/Dense>

#include "src/parallel/parallel.hpp"

namespace ricochet::modes {

/// A symmetric matrix (SBAIJ) ready to multiply blocks of columns.
///
/// On one rank its entries are copied once (of a mass matrix, whose blocks are diagonal, these alone) and
/// used on 8 columns at a time: a product then reads the matrix once for all of them. On several ranks PETSc
/// multiplies column by column.
class BlockProduct {
 public:
  /// Collective on the matrix's ranks; the matrix has to live as long as this.
  explicit BlockProduct(Mat matrix);

  /// A X. @param columns (local rows, n), @return likewise. Collective.
  Eigen::MatrixXd operator()(const Eigen::Ref<const Eigen::MatrixXd>& columns) const;

 private:
  void take_diagonals(const double* upper, std::size_t entries);

  Mat matrix_;
  bool serial_ = false, diagonal_ = false;
  PetscInt block_ = 1;
  std::vector<PetscInt> start_,
      column_;                 ///< block rows: of the upper triangle; whole where blocks are diagonal
  std::vector<double> value_;  ///< blocks column-major, or their diagonals
};

}  // namespace ricochet::modes
