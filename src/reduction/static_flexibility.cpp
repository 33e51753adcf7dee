// SPDX-License-Identifier: BSD-2-Clause
#include "src/reduction/static_flexibility.hpp"

#include <limits>
#include <numeric>

#include "src/modes/mumps.hpp"

namespace ricochet::reduction {

Loads beside(const std::vector<Loads>& blocks) {
  Eigen::Index columns = 0, entries = 0;
  for (const Loads& block : blocks) {
    columns += block.cols();
    entries += block.nonZeros();
  }
  Loads all(blocks.front().rows(), columns);
  all.reserve(entries);
  Eigen::Index at = 0;
  for (const Loads& block : blocks)
    for (Eigen::Index j = 0; j < block.cols(); ++j) {
      all.startVec(at);
      for (Loads::InnerIterator entry(block, j); entry; ++entry)
        all.insertBack(entry.row(), at) = entry.value();
      ++at;
    }
  all.finalize();
  return all;
}

std::vector<std::int64_t> determinate_rows(MPI_Comm comm, Eigen::MatrixXd rigid, std::int64_t first) {
  std::vector<std::int64_t> rows;
  for (Eigen::Index k = 0; k < rigid.cols(); ++k) {
    struct {
      double size;
      int row;
    } mine{-1, std::numeric_limits<int>::max()}, largest{};
    Eigen::Index at = 0;
    if (rigid.rows() > 0) {
      mine.size = rigid.rowwise().squaredNorm().maxCoeff(&at);
      mine.row = static_cast<int>(first + at);
    }
    MPI_Allreduce(&mine, &largest, 1, MPI_DOUBLE_INT, MPI_MAXLOC, comm);
    rows.push_back(largest.row);
    Eigen::RowVectorXd direction = Eigen::RowVectorXd::Zero(rigid.cols());
    if (rigid.rows() > 0 && largest.row == mine.row) direction = rigid.row(at).normalized();
    parallel::sum(comm, direction);
    rigid -= (rigid * direction.transpose()).eval() * direction;
  }
  return rows;
}

BorderedStiffness::BorderedStiffness(const parallel::Teams& teams, const modes::Factorisation& factor,
                                     const std::vector<std::int64_t>& on_springs, const Loads& border)
    : world_(teams.world()),
      border_(border.cols()),
      mumps_(std::make_unique<modes::Mumps>(teams.world(), modes::Mumps::Symmetry::definite)) {
  const modes::Entries& matrix = factor.entries();
  const int rows = static_cast<int>(matrix.rows);
  if (teams.mine() == 0) {
    row_ = matrix.row;
    column_ = matrix.column;
    value_ = matrix.stiffness;
    // MUMPS adds entries that occur twice.
    for (std::size_t k = 0; k < matrix.row.size(); ++k)
      if (matrix.row[k] == matrix.column[k] &&
          std::ranges::find(on_springs, matrix.row[k] - 1) != on_springs.end()) {
        row_.push_back(matrix.row[k]);
        column_.push_back(matrix.row[k]);
        value_.push_back(matrix.stiffness[k]);
      }
    for (Eigen::Index j = 0; j < border.cols(); ++j)
      for (Loads::InnerIterator entry(border, j); entry; ++entry) {
        row_.push_back(static_cast<int>(matrix.first + entry.row()) + 1);
        column_.push_back(rows + static_cast<int>(j) + 1);
        value_.push_back(entry.value());
      }
  }
  order_ = factor.order();
  const bool first = parallel::rank_of(world_) == 0;
  kept_.resize(static_cast<std::size_t>(border_));
  std::iota(kept_.begin(), kept_.end(), rows + 1);
  if (first) order_.insert(order_.end(), kept_.begin(), kept_.end());

  DMUMPS_STRUC_C& id = mumps_->id();
  id.n = rows + static_cast<int>(border_);
  mumps_->icntl(7) = 1;
  id.perm_in = order_.data();
  const auto count = static_cast<MUMPS_INT8>(row_.size());
  if (parallel::size_of(world_) == 1) {
    id.nnz = count;
    id.irn = row_.data();
    id.jcn = column_.data();
  } else {
    mumps_->icntl(18) = 3;
    id.nnz_loc = count;
    id.irn_loc = row_.data();
    id.jcn_loc = column_.data();
  }
  mumps_->take_users_options();
  constexpr int whole_complement = 3, discarded = 1;
  mumps_->icntl(19) = whole_complement;
  mumps_->icntl(31) = discarded;
  id.size_schur = static_cast<MUMPS_INT>(border_);
  id.listvar_schur = kept_.data();
  // The complement is one block on the first rank.
  id.nprow = id.npcol = 1;
  id.mblock = id.nblock = 64;
  mumps_->run(modes::Mumps::Job::analyse, "analyse the bordered K");
}

BorderedStiffness::~BorderedStiffness() = default;

double BorderedStiffness::expected_mib() const {
  const double result = parallel::rank_of(world_) == 0 ? 8.0 * static_cast<double>(border_ * border_) : 0;
  return (static_cast<double>(mumps_->info(15)) * 1e6 + result) / (1 << 20);
}

Eigen::MatrixXd BorderedStiffness::flexibility() {
  DMUMPS_STRUC_C& id = mumps_->id();
  const Eigen::Index here = parallel::rank_of(world_) == 0 ? border_ : 0;
  Eigen::MatrixXd complement(here, here);
  id.schur = complement.data();
  id.schur_lld = static_cast<MUMPS_INT>(border_);
  (parallel::size_of(world_) == 1 ? id.a : id.a_loc) = value_.data();
  if (!mumps_->factor("factor the bordered K"))
    throw SolverError("K is singular: the rigid motions of the body are not all known");
  mumps_.reset();
  complement *= -1;
  return complement;
}

}  // namespace ricochet::reduction
