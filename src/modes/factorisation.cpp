// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/factorisation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "src/modes/mumps.hpp"
#include "src/modes/tall.hpp"

namespace ricochet::modes {

namespace {

constexpr int low_rank_factors_and_solves = 2;
constexpr const char* factor_task = "factor K − σM";
constexpr const char* solve_task = "solve with K − σM";

}  // namespace

Factorisation::Factorisation(Mat stiffness, Mat mass, double low_rank)
    : entries_(stiffness, mass), shifted_(entries_.stiffness.size()), low_rank_(low_rank) {
  MPI_Comm_dup(parallel::comm_of(stiffness), &comm_);
  const int start = static_cast<int>(entries_.first);
  first_of_rank_.resize(static_cast<std::size_t>(parallel::size_of(comm_)));
  MPI_Allgather(&start, 1, MPI_INT, first_of_rank_.data(), 1, MPI_INT, comm_);
  own_row_.resize(static_cast<std::size_t>(entries_.local_rows));
  std::iota(own_row_.begin(), own_row_.end(), start + 1);

  order_ = order_of_elimination(comm_, entries_);
  analyse();
}

void Factorisation::analyse() {
  mumps_.reset();
  mumps_ = std::make_unique<Mumps>(comm_, Mumps::Symmetry::indefinite);
  DMUMPS_STRUC_C& id = mumps_->id();
  id.n = static_cast<MUMPS_INT>(entries_.rows);
  mumps_->icntl(7) = 1;
  id.perm_in = order_.data();
  const auto count = static_cast<MUMPS_INT8>(entries_.row.size());
  if (parallel::size_of(comm_) == 1) {
    id.nnz = count;
    id.irn = entries_.row.data();
    id.jcn = entries_.column.data();
  } else {
    mumps_->icntl(18) = 3;  // entries, right-hand sides and solutions are distributed
    mumps_->icntl(20) = 10;
    mumps_->icntl(21) = 1;
    id.nnz_loc = count;
    id.irn_loc = entries_.row.data();
    id.jcn_loc = entries_.column.data();
  }
  if (low_rank_ > 0) {
    mumps_->icntl(35) = low_rank_factors_and_solves;
    mumps_->cntl(7) = low_rank_;
  }
  mumps_->take_users_options();
  mumps_->run(Mumps::Job::analyse, "analyse K − σM");
}

Factorisation::~Factorisation() {
  mumps_.reset();
  MPI_Comm_free(&comm_);
}

void Factorisation::factor(double sigma) {
  if (factored_ && sigma == sigma_) return;
  factored_ = false;
  DMUMPS_STRUC_C& id = mumps_->id();
  (parallel::size_of(comm_) == 1 ? id.a : id.a_loc) = shifted_.data();
  constexpr int attempts = 5;
  for (int attempt = 0; !factored_; ++attempt) {
    for (std::size_t k = 0; k < shifted_.size(); ++k)
      shifted_[k] = entries_.stiffness[k] - sigma * entries_.mass[k];
    factored_ = mumps_->factor(factor_task);
    if (attempt == attempts) break;
    // A shift that equals an eigenvalue is raised.
    if (!factored_) sigma += 1e-6 * std::abs(sigma);
  }
  if (!factored_) throw SolverError(fmt::format("MUMPS could not {}: it is singular", factor_task));
  sigma_ = sigma;
  below_ = mumps_->infog(12);
}

void Factorisation::factor_on_springs(std::span<const std::int64_t> on_springs) {
  factored_ = false;
  DMUMPS_STRUC_C& id = mumps_->id();
  (parallel::size_of(comm_) == 1 ? id.a : id.a_loc) = shifted_.data();
  for (std::size_t k = 0; k < shifted_.size(); ++k) {
    const int row = entries_.row[k];
    const bool spring =
        row == entries_.column[k] && std::ranges::find(on_springs, row - 1) != on_springs.end();
    shifted_[k] = (spring ? 2 : 1) * entries_.stiffness[k];
  }
  factored_ = mumps_->factor(factor_task);
  if (!factored_) throw SolverError("K is singular: the rigid motions of the body are not all known");
  sigma_ = std::numeric_limits<double>::quiet_NaN();
}

Eigen::MatrixXd Factorisation::solve(const Eigen::Ref<const Eigen::MatrixXd>& right) {
  if (!factored_) throw SolverError("internal: a solve without factors");
  DMUMPS_STRUC_C& id = mumps_->id();
  const Eigen::Index n = right.cols();
  Eigen::MatrixXd solution = right;
  if (n == 0) return solution;
  id.nrhs = static_cast<MUMPS_INT>(n);
  id.lrhs = id.n;
  mumps_->icntl(27) = static_cast<MUMPS_INT>(std::min<Eigen::Index>(n, 64));
  if (parallel::size_of(comm_) == 1) {
    id.rhs = solution.data();
    mumps_->run(Mumps::Job::solve, solve_task);
    return solution;
  }
  // MUMPS takes the rows of each rank, and returns those of the pivots that the rank has eliminated.
  id.nloc_rhs = id.lrhs_loc = static_cast<MUMPS_INT>(right.rows());
  id.irhs_loc = own_row_.data();
  id.rhs_loc = solution.data();
  id.lsol_loc = mumps_->info(23);
  eliminated_row_.resize(static_cast<std::size_t>(id.lsol_loc));
  id.isol_loc = eliminated_row_.data();
  Eigen::MatrixXd eliminated(id.lsol_loc, n);
  id.sol_loc = eliminated.data();
  mumps_->run(Mumps::Job::solve, solve_task);
  return_rows(eliminated, solution);
  return solution;
}

void Factorisation::return_rows(const Eigen::MatrixXd& eliminated, Eigen::MatrixXd& solution) const {
  // Sends each owner the numbers of its rows, and then their values column by column.
  std::vector<std::vector<Eigen::Index>> from(static_cast<std::size_t>(parallel::size_of(comm_)));
  std::vector<std::vector<double>> to(from.size());
  for (std::size_t i = 0; i < eliminated_row_.size(); ++i) {
    const int row = eliminated_row_[i] - 1;
    const auto owner =
        static_cast<std::size_t>(std::ranges::upper_bound(first_of_rank_, row) - first_of_rank_.begin()) - 1;
    from[owner].push_back(static_cast<Eigen::Index>(i));
    to[owner].push_back(row - first_of_rank_[owner]);
  }
  for (std::size_t rank = 0; rank < to.size(); ++rank) {
    to[rank].reserve(from[rank].size() * static_cast<std::size_t>(solution.cols() + 1));
    for (Eigen::Index j = 0; j < solution.cols(); ++j)
      for (const Eigen::Index i : from[rank]) to[rank].push_back(eliminated(i, j));
  }
  for (const std::vector<double>& got : parallel::exchange(comm_, to)) {
    const std::size_t rows = got.size() / static_cast<std::size_t>(solution.cols() + 1);
    for (Eigen::Index j = 0; j < solution.cols(); ++j) {
      const double* column = got.data() + (static_cast<std::size_t>(j) + 1) * rows;
      for (std::size_t i = 0; i < rows; ++i) solution(static_cast<Eigen::Index>(got[i]), j) = column[i];
    }
  }
}

void Factorisation::release() {
  // MUMPS frees factors only with everything else. With a given order, the analysis is cheap.
  if (factored_) analyse();
  factored_ = false;
}

double Factorisation::expected_mib() const {
  // INFO(15), or INFO(30) for low rank, in millions of bytes.
  return static_cast<double>(mumps_->info(low_rank_ > 0 ? 30 : 15)) * 1e6 / (1 << 20);
}

Eigen::MatrixXd shared_solve(const parallel::Teams& teams, Factorisation& factor,
                             const Eigen::Ref<const Eigen::MatrixXd>& right) {
  const auto [first, columns] = teams.share(right.cols());
  if (teams.count() == 1) return factor.solve(right);
  Eigen::MatrixXd solution = Eigen::MatrixXd::Zero(right.rows(), right.cols());
  solution.middleCols(first, columns) = factor.solve(right.middleCols(first, columns));
  parallel::sum(teams.peers(), solution);
  return solution;
}

Eigen::MatrixXd inner(MPI_Comm comm, const Eigen::Ref<const Eigen::MatrixXd>& x,
                      const Eigen::Ref<const Eigen::MatrixXd>& y) {
  Eigen::MatrixXd product = tall_inner(x, y);
  parallel::sum(comm, product);
  return product;
}

Eigen::MatrixXd inner(MPI_Comm comm, const Eigen::SparseMatrix<double>& x, const Eigen::MatrixXd& y) {
  Eigen::MatrixXd product = x.transpose() * y;
  parallel::sum(comm, product);
  return product;
}

}  // namespace ricochet::modes
