// SPDX-License-Identifier: BSD-2-Clause
// Static flexibility between loads, from one partial factorisation.
#pragma once

#include <Eigen/Dense>
#include <Eigen/SparseCore>
#include <vector>

#include "src/modes/factorisation.hpp"

namespace ricochet::reduction {

/// Loads on the mesh: (local rows, b) [N], fixed components 0. Loads of patches touch few rows.
using Loads = Eigen::SparseMatrix<double>;

/// Joins loads side by side. All have the same rows.
Loads beside(const std::vector<Loads>& blocks);

/// Returns rows in which r rigid motions differ most, one row for each motion (pivoted Gram–Schmidt). Springs
/// at these rows support the body in a statically determinate way: loads in equilibrium cause no forces in
/// them, whatever their stiffness, and K X = F is solved exactly up to a rigid motion.
/// @param rigid  (local rows, r), @param first  global number of the first local row
/// @return (r) global rows, the same on every rank of `comm`. Collective.
std::vector<std::int64_t> determinate_rows(MPI_Comm comm, Eigen::MatrixXd rigid, std::int64_t first);

/// The bordered matrix [A F; Fᵀ 0] with A = K and springs at some rows, as stiff as its diagonal there. MUMPS
/// eliminates the unknowns of A alone. What remains is minus the flexibility Fᵀ A⁻¹ F. The factors are
/// discarded as soon as they are computed. The elimination exploits the zeros of F, and costs little more
/// than a factorisation of A: neither a solution nor a right-hand side on the whole mesh is ever formed.
///
/// All ranks of the world share the work; the entries are those of the first team.
class BorderedStiffness {
 public:
  /// Runs the analysis. Collective on all ranks of `teams`. Throws SolverError if MUMPS breaks down.
  /// @param factor  of the team, for its entries and its order of elimination
  /// @param on_springs  global rows with springs
  /// @param border  F, (local rows, b), the same in every team
  BorderedStiffness(const parallel::Teams& teams, const modes::Factorisation& factor,
                    const std::vector<std::int64_t>& on_springs, const Loads& border);

  /// Memory that `flexibility` needs on this rank, as estimated by MUMPS, with the result [MiB].
  double expected_mib() const;

  /// Returns Fᵀ A⁻¹ F (b, b), symmetric, on the first rank; empty on the others. Collective. Throws
  /// SolverError if memory is insufficient or MUMPS breaks down.
  Eigen::MatrixXd flexibility();

  ~BorderedStiffness();
  BorderedStiffness(const BorderedStiffness&) = delete;
  BorderedStiffness& operator=(const BorderedStiffness&) = delete;

 private:
  MPI_Comm world_;
  Eigen::Index border_;
  std::unique_ptr<modes::Mumps> mumps_;
  std::vector<int> row_, column_, order_, kept_;
  std::vector<double> value_;
};

}  // namespace ricochet::reduction
