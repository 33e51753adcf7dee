// SPDX-License-Identifier: BSD-2-Clause
// K and M, prepared for the eigensolver.
#pragma once

#include <cstdint>

#include "kernels/expected_modes.hpp"
#include "src/elasticity/assemble.hpp"
#include "src/modes/factorisation.hpp"
#include "src/modes/product.hpp"

namespace ricochet::modes {

/// It increases without bound, and is the same on every rank.
using kernels::ExpectedCount;

/// K and M on one team of ranks, with known modes at zero.
struct Operators {
  /// K and M of a body, with its rigid modes. Collective on the team.
  Operators(const mesh::Mesh& mesh, const elasticity::Body& body);

  /// Any symmetric K and M. Collective on the ranks of the matrices, which must outlive this object.
  /// @param stiffness, mass  SBAIJ with the same pattern, in blocks of 1 or 3; M positive semidefinite
  /// @param known  (local rows, r) eigenvectors that are not sought, M-orthonormal
  Operators(Mat stiffness, Mat mass, const Eigen::MatrixXd& known);

  MPI_Comm comm;
  std::int64_t local_rows, total_rows;
  BlockProduct stiffness, mass;
  Eigen::MatrixXd rigid;           ///< (local rows, r), M-orthonormal
  Eigen::MatrixXd rigid_momentum;  ///< M times `rigid`
  /// Number of eigenvalues below zero, or at it, that are not sought: r for a body.
  std::int64_t below_zero;
  Eigen::VectorXd diagonal;       ///< (local rows) of K
  Eigen::VectorXd mass_diagonal;  ///< (local rows) of M; 0 in fixed rows
  std::int64_t free_rows;         ///< number of rows with mass, and so of finite eigenvalues
  /// (local rows) number of the row in reading order, independent of the number of ranks
  std::vector<std::int64_t> key;

  /// Returns columns of noise in [−1, 1] that depend only on `seed` and the keys of the rows.
  /// @return (local rows, n)
  Eigen::MatrixXd noise(Eigen::Index n, std::uint64_t seed) const;

  /// Returns ‖Kφ − λMφ‖₂ / ‖Kφ‖₂ of each column. Collective.
  Eigen::VectorXd residuals(const Eigen::Ref<const Eigen::MatrixXd>& shape,
                            const Eigen::VectorXd& lambda) const;

  /// Returns the residual due to round-off alone, 8 ε ‖diag(K) φ‖₂ / ‖Kφ‖₂ of each column. No φ in double
  /// precision has a smaller residual. It exceeds 1e-8 for the lowest modes of a thin body on a fine mesh.
  /// Collective.
  Eigen::VectorXd round_off(const Eigen::Ref<const Eigen::MatrixXd>& shape) const;

  /// Returns the largest K_ii/M_ii [rad²/s²], a lower bound on the highest eigenvalue and close to it.
  /// Collective.
  double stiffest() const;

  /// Returns Weyl's law for a solid, N ~ λ^(3/2). Collective.
  ExpectedCount expected_count() const;

  /// Throws InputError on every rank if a band ends where the mesh carries no information. One such range
  /// begins a thousand times above the highest frequency of the mesh, where K is negligible compared with σM.
  /// With `from_zero`, another such range is near zero, where round-off gives rigid motions a frequency.
  /// Collective.
  void refuse_band(Hertz up_to, bool from_zero) const;

  /// Returns the 2-norm of each column over the team. Collective.
  Eigen::VectorXd norms(const Eigen::MatrixXd& columns) const;
};

}  // namespace ricochet::modes
