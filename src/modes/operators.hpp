// SPDX-License-Identifier: BSD-2-Clause
// One body's K and M as the eigensolver needs them.
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
  Eigen::MatrixXd rigid_momentum;  ///< M times it
  Eigen::VectorXd diagonal;        ///< (local rows) of K
  std::vector<std::int64_t> key;   ///< (local rows) the row's number in reading order, whatever the ranks

  /// Columns of noise in [−1, 1] that depend on the rows' keys alone. @return (local rows, n)
  Eigen::MatrixXd noise(Eigen::Index n, std::uint64_t seed) const;

  /// ‖Kφ − λMφ‖₂ / ‖Kφ‖₂ of each column. Collective.
  Eigen::VectorXd residuals(const Eigen::Ref<const Eigen::MatrixXd>& shape,
                            const Eigen::VectorXd& lambda) const;

  /// What round-off alone makes of a residual: 8 ε ‖diag(K) φ‖₂ / ‖Kφ‖₂ of each column. No φ in double
  /// precision has a smaller one; for the lowest modes of a thin body on a fine mesh it passes 1e-8.
  /// Collective.
  Eigen::VectorXd round_off(const Eigen::Ref<const Eigen::MatrixXd>& shape) const;

  /// The largest K_ii/M_ii, a lower bound of the highest eigenvalue and near to it [rad²/s²]. Collective.
  double stiffest() const;

  /// Throws InputError on every rank for a band that ends beyond what this mesh knows of: thousands of times
  /// above its highest mode, where K is lost beside the shift times M; or, with `from_zero`, where round-off
  /// gives rigid motions a frequency. Collective.
  void refuse_band(Hertz up_to, bool from_zero) const;

  /// Column 2-norms over the team. Collective.
  Eigen::VectorXd norms(const Eigen::MatrixXd& columns) const;
};

}  // namespace ricochet::modes
