// SPDX-License-Identifier: BSD-2-Clause
// K and M of a body, as the eigensolver needs them.
#pragma once

#include <cstdint>

#include "src/elasticity/assemble.hpp"
#include "src/modes/factorisation.hpp"
#include "src/modes/product.hpp"

namespace ricochet::modes {

/// K and M of a body on one team of ranks, with its rigid modes.
struct Operators {
  /// Collective on the team.
  Operators(const mesh::Mesh& mesh, const elasticity::Body& body);

  MPI_Comm comm;
  const elasticity::Body& body;
  BlockProduct stiffness, mass;
  Eigen::MatrixXd rigid;           ///< (local rows, r), M-orthonormal
  Eigen::MatrixXd rigid_momentum;  ///< M times `rigid`
  Eigen::VectorXd diagonal;        ///< (local rows) of K
  std::vector<std::int64_t>
      key;  ///< (local rows) number of the row in reading order, independent of the ranks

  /// Columns of noise in [−1, 1] that depend only on the keys of the rows. @return (local rows, n)
  Eigen::MatrixXd noise(Eigen::Index n, std::uint64_t seed) const;

  /// ‖Kφ − λMφ‖₂ / ‖Kφ‖₂ of each column. Collective.
  Eigen::VectorXd residuals(const Eigen::Ref<const Eigen::MatrixXd>& shape,
                            const Eigen::VectorXd& lambda) const;

  /// The residual due to round-off alone: 8 ε ‖diag(K) φ‖₂ / ‖Kφ‖₂ of each column. No φ in double precision
  /// has a smaller one; for the lowest modes of a thin body on a fine mesh it exceeds 1e-8. Collective.
  Eigen::VectorXd round_off(const Eigen::Ref<const Eigen::MatrixXd>& shape) const;

  /// The largest K_ii/M_ii: a lower bound of the highest eigenvalue, and close to it [rad²/s²]. Collective.
  double stiffest() const;

  /// Throws InputError on every rank if a band ends where this mesh carries no information: thousands of
  /// times above its highest mode, where K is negligible beside the shift times M; or, with `from_zero`,
  /// where round-off gives rigid motions a frequency. Collective.
  void refuse_band(Hertz up_to, bool from_zero) const;

  /// Column 2-norms over the team. Collective.
  Eigen::VectorXd norms(const Eigen::MatrixXd& columns) const;
};

}  // namespace ricochet::modes
