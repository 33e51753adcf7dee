// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/dense.hpp"

#include <algorithm>
#include <cmath>

#include "src/modes/symmetric.hpp"
#include "src/parallel/parallel.hpp"

namespace ricochet::modes {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

/// The lower triangle of a matrix on the first rank of the team; empty elsewhere. Collective.
MatrixXd gathered(MPI_Comm comm, const Entries& entries, const std::vector<int>& row,
                  const std::vector<int>& column, const std::vector<double>& mine) {
  const std::vector<double> value = parallel::gather(comm, mine);
  if (parallel::rank_of(comm) != 0) return {};
  MatrixXd whole = MatrixXd::Zero(entries.rows, entries.rows);
  for (std::size_t k = 0; k < value.size(); ++k) whole(column[k] - 1, row[k] - 1) = value[k];
  return whole;
}

/// The rows of all ranks on the first one; empty elsewhere. Collective.
MatrixXd gathered(MPI_Comm comm, const MatrixXd& mine) {
  const MatrixXd across = mine.transpose();
  const std::vector<double> all =
      parallel::gather(comm, std::vector<double>(across.data(), across.data() + across.size()));
  if (parallel::rank_of(comm) != 0) return {};
  return Eigen::Map<const MatrixXd>(all.data(), mine.cols(), static_cast<Index>(all.size()) / mine.cols())
      .transpose();
}

}  // namespace

bool dense_is_faster(std::int64_t rows, std::int64_t modes) {
  // Measured on boxes of tetrahedra: 2.2e-10 s rows³, against 6e-7 s rows modes.
  constexpr std::int64_t few = 300, ratio = 2500;
  return rows <= few || rows * rows < ratio * modes;
}

Converged dense_modes(const Operators& operators, const Entries& entries, const Interval& wanted) {
  MPI_Comm comm = operators.comm;
  const double sigma = -1e-3 * wanted.to;
  const std::vector<int> row = parallel::gather(comm, entries.row),
                         column = parallel::gather(comm, entries.column);
  MatrixXd mass = gathered(comm, entries, row, column, entries.mass),
           shifted = gathered(comm, entries, row, column, entries.stiffness);
  const MatrixXd momentum =
      operators.rigid.cols() > 0 ? gathered(comm, operators.rigid_momentum) : MatrixXd();
  std::vector<double> lambda, shape;
  if (parallel::rank_of(comm) == 0) {
    shifted -= sigma * mass;
    if (momentum.size() > 0) mass -= momentum * momentum.transpose();
    const Eigen::VectorXd theta = eigen_decomposition(mass, shifted);
    for (Index k = theta.size(); k-- > 0 && theta[k] > 0;) {
      const double value = sigma + 1 / theta[k];
      if (value > wanted.to) break;
      if (value < wanted.from) continue;
      lambda.push_back(value);
      const Eigen::VectorXd normal = mass.col(k) / std::sqrt(theta[k]);
      shape.insert(shape.end(), normal.begin(), normal.end());
    }
  }
  parallel::broadcast(comm, lambda);
  parallel::broadcast(comm, shape);
  Converged found;
  found.covered = wanted;
  found.lambda = Eigen::Map<const Eigen::VectorXd>(lambda.data(), static_cast<Index>(lambda.size()));
  found.shape = Eigen::Map<const MatrixXd>(shape.data(), entries.rows, found.lambda.size())
                    .middleRows(entries.first, entries.local_rows);
  return found;
}

}  // namespace ricochet::modes
