// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/factorisation.hpp"

#include <dmumps_c.h>
#include <fmt/format.h>
#include <metis.h>

#include <algorithm>
#include <cmath>

namespace ricochet::modes {

using parallel::check;

struct Factorisation::Mumps {
  DMUMPS_STRUC_C id{};
  /// Parameters are numbered as in the manual of MUMPS.
  MUMPS_INT& icntl(int k) { return id.icntl[k - 1]; }
  MUMPS_INT infog(int k) const { return id.infog[k - 1]; }
};

namespace {

constexpr int job_init = -1, job_end = -2, job_analyse = 1, job_factor = 2, job_solve = 3;
constexpr int symmetric_indefinite = 2, host_works = 1, low_rank_factors_and_solves = 2;

}  // namespace

Factorisation::Factorisation(Mat stiffness, Mat mass, double low_rank)
    : mumps_(std::make_unique<Mumps>()), low_rank_(low_rank) {
  MPI_Comm comm = MPI_COMM_NULL;
  check(PetscObjectGetComm(reinterpret_cast<PetscObject>(stiffness), &comm));
  MPI_Comm_dup(comm, &comm_);
  collect_entries(stiffness, mass);

  DMUMPS_STRUC_C& id = mumps_->id;
  id.sym = symmetric_indefinite;
  id.par = host_works;
  id.comm_fortran = MPI_Comm_c2f(comm_);
  run(job_init, "start");
  // Disables output, and ScaLAPACK at the root, which would hide a part of the inertia.
  for (int k : {1, 2, 3}) mumps_->icntl(k) = -1;
  mumps_->icntl(4) = 0;
  mumps_->icntl(13) = 1;
  id.n = static_cast<MUMPS_INT>(rows_);
  const auto entries = static_cast<MUMPS_INT8>(row_.size());
  order_by_metis(stiffness);
  mumps_->icntl(7) = 1;
  id.perm_in = order_.data();
  if (parallel::size_of(comm_) == 1) {
    id.nnz = entries;
    id.irn = row_.data();
    id.jcn = column_.data();
  } else {
    mumps_->icntl(18) = 3;
    id.nnz_loc = entries;
    id.irn_loc = row_.data();
    id.jcn_loc = column_.data();
  }
  if (low_rank_ > 0) {
    mumps_->icntl(35) = low_rank_factors_and_solves;
    id.cntl[6] = low_rank_;
  }
  take_users_options();
  run(job_analyse, "analyse");
}

void Factorisation::take_users_options() {
  // Options have the names that PETSc gives them. Those on which inertia counts rely (13, 35) and those for
  // data input cannot be set.
  for (int k : {4, 6, 8, 10, 12, 14, 22, 23, 24, 31, 58}) {
    PetscInt value = 0;
    PetscBool given = PETSC_FALSE;
    check(
        PetscOptionsGetInt(nullptr, nullptr, fmt::format("-mat_mumps_icntl_{}", k).c_str(), &value, &given));
    if (given) mumps_->icntl(k) = static_cast<MUMPS_INT>(value);
  }
  if (mumps_->icntl(4) > 0)
    for (int k : {1, 2, 3}) mumps_->icntl(k) = 6;
  for (int k : {1, 3, 4}) {
    PetscReal value = 0;
    PetscBool given = PETSC_FALSE;
    check(
        PetscOptionsGetReal(nullptr, nullptr, fmt::format("-mat_mumps_cntl_{}", k).c_str(), &value, &given));
    if (given) mumps_->id.cntl[k - 1] = value;
  }
}

Factorisation::~Factorisation() {
  mumps_->id.job = job_end;
  dmumps_c(&mumps_->id);
  MPI_Comm_free(&comm_);
}

void Factorisation::collect_entries(Mat stiffness, Mat mass) {
  PetscInt first = 0, behind = 0, total = 0;
  check(MatGetOwnershipRange(stiffness, &first, &behind));
  check(MatGetSize(stiffness, &total, nullptr));
  local_rows_ = behind - first;
  rows_ = total;
  const int mine = static_cast<int>(local_rows_), start = static_cast<int>(first);
  rows_of_rank_.resize(static_cast<std::size_t>(parallel::size_of(comm_)));
  first_of_rank_.resize(rows_of_rank_.size());
  MPI_Allgather(&mine, 1, MPI_INT, rows_of_rank_.data(), 1, MPI_INT, comm_);
  MPI_Allgather(&start, 1, MPI_INT, first_of_rank_.data(), 1, MPI_INT, comm_);
  for (Mat matrix : {stiffness, mass}) {
    std::vector<double>& value = matrix == stiffness ? stiffness_ : mass_;
    check(MatGetRowUpperTriangular(matrix));
    for (PetscInt i = first; i < behind; ++i) {
      PetscInt n = 0;
      const PetscInt* column = nullptr;
      const double* entry = nullptr;
      check(MatGetRow(matrix, i, &n, &column, &entry));
      for (PetscInt k = 0; k < n; ++k) {
        if (column[k] < i) continue;
        value.push_back(entry[k]);
        if (matrix == mass) continue;
        row_.push_back(static_cast<int>(i) + 1);
        column_.push_back(static_cast<int>(column[k]) + 1);
      }
      check(MatRestoreRow(matrix, i, &n, &column, &entry));
    }
    check(MatRestoreRowUpperTriangular(matrix));
  }
  if (mass_.size() != stiffness_.size()) throw SolverError("internal: K and M differ in their pattern");
  shifted_.resize(stiffness_.size());
}

void Factorisation::order_by_metis(Mat stiffness) {
  PetscInt block = 1;
  check(MatGetBlockSize(stiffness, &block));
  // Edges between nodes, one for each block, gathered on the first rank.
  std::vector<int> edge;
  for (std::size_t k = 0; k < row_.size(); ++k) {
    const int i = row_[k] - 1, j = column_[k] - 1;
    if (i % block == 0 && j % block == 0 && i != j) edge.insert(edge.end(), {i / block, j / block});
  }
  edge = parallel::gather(comm_, edge);
  if (parallel::rank_of(comm_) != 0) return;

  // The graph contains each edge at both of its ends.
  const auto nodes = static_cast<std::size_t>(rows_ / block);
  std::vector<idx_t> start(nodes + 1, 0), neighbour(edge.size());
  for (int node : edge) ++start[static_cast<std::size_t>(node) + 1];
  for (std::size_t i = 0; i < nodes; ++i) start[i + 1] += start[i];
  std::vector<idx_t> next(start.begin(), start.end() - 1);
  for (std::size_t k = 0; k < edge.size(); k += 2) {
    neighbour[static_cast<std::size_t>(next[static_cast<std::size_t>(edge[k])]++)] = edge[k + 1];
    neighbour[static_cast<std::size_t>(next[static_cast<std::size_t>(edge[k + 1])]++)] = edge[k];
  }
  auto n = static_cast<idx_t>(nodes);
  std::vector<idx_t> order(static_cast<std::size_t>(n)), place(order.size());
  if (neighbour.empty()) {
    for (idx_t i = 0; i < n; ++i) place[static_cast<std::size_t>(i)] = i;
  } else {
    idx_t options[METIS_NOPTIONS];
    METIS_SetDefaultOptions(options);
    if (METIS_NodeND(&n, start.data(), neighbour.data(), nullptr, options, order.data(), place.data()) !=
        METIS_OK)
      throw SolverError("METIS could not order the nodes");
  }
  for (idx_t p : place)
    for (PetscInt c = 0; c < block; ++c) order_.push_back(static_cast<int>(p) * block + c + 1);
}

void Factorisation::run(int job, const char* task) {
  mumps_->id.job = job;
  dmumps_c(&mumps_->id);
  succeed(task);
}

void Factorisation::succeed(const char* task) const {
  const int code = mumps_->infog(1);
  if (code >= 0) return;
  const bool memory = code == -7 || code == -8 || code == -9 || code == -13 || code == -19;
  throw SolverError(fmt::format("MUMPS could not {} K − σM (INFOG(1) = {}, INFOG(2) = {}){}", task, code,
                                mumps_->infog(2),
                                memory ? ": not enough memory, use more ranks or a coarser mesh" : ""));
}

void Factorisation::factor(double sigma) {
  constexpr int singular = -10, more_integers = -8, more_reals = -9;
  if (factored_ && sigma == sigma_) return;
  factored_ = false;
  DMUMPS_STRUC_C& id = mumps_->id;
  (parallel::size_of(comm_) == 1 ? id.a : id.a_loc) = shifted_.data();
  for (int attempt = 0;; ++attempt) {
    for (std::size_t k = 0; k < shifted_.size(); ++k) shifted_[k] = stiffness_[k] - sigma * mass_[k];
    id.job = job_factor;
    dmumps_c(&id);
    const int code = mumps_->infog(1);
    if (attempt == 4 || (code != singular && code != more_integers && code != more_reals)) break;
    // A shift that equals an eigenvalue is raised. Delayed pivots may need more memory than the analysis
    // estimated.
    if (code == singular) {
      sigma += 1e-6 * std::abs(sigma);
    } else {
      mumps_->icntl(14) = 2 * std::max<MUMPS_INT>(mumps_->icntl(14), 20);
    }
  }
  succeed("factor");
  sigma_ = sigma;
  below_ = mumps_->infog(12);
  factored_ = true;
}

Eigen::MatrixXd Factorisation::solve(const Eigen::Ref<const Eigen::MatrixXd>& right) {
  if (!factored_) throw SolverError("internal: a solve without factors");
  DMUMPS_STRUC_C& id = mumps_->id;
  const Eigen::Index n = right.cols();
  Eigen::MatrixXd solution = right;
  if (n == 0) return solution;
  id.nrhs = static_cast<MUMPS_INT>(n);
  id.lrhs = id.n;
  mumps_->icntl(27) = static_cast<MUMPS_INT>(std::min<Eigen::Index>(n, 64));
  if (parallel::size_of(comm_) == 1) {
    id.rhs = solution.data();
    run(job_solve, "solve with");
    return solution;
  }
  // MUMPS takes right-hand sides and returns solutions on the first rank.
  const bool first = parallel::rank_of(comm_) == 0;
  Eigen::MatrixXd whole(first ? rows_ : 0, n);
  for (Eigen::Index j = 0; j < n; ++j)
    MPI_Gatherv(right.col(j).data(), static_cast<int>(local_rows_), MPI_DOUBLE,
                first ? whole.col(j).data() : nullptr, rows_of_rank_.data(), first_of_rank_.data(),
                MPI_DOUBLE, 0, comm_);
  id.rhs = whole.data();
  run(job_solve, "solve with");
  for (Eigen::Index j = 0; j < n; ++j)
    MPI_Scatterv(first ? whole.col(j).data() : nullptr, rows_of_rank_.data(), first_of_rank_.data(),
                 MPI_DOUBLE, solution.col(j).data(), static_cast<int>(local_rows_), MPI_DOUBLE, 0, comm_);
  return solution;
}

double Factorisation::expected_mib() const {
  // INFO(15), or INFO(30) for low rank, in millions of bytes.
  return static_cast<double>(mumps_->id.info[low_rank_ > 0 ? 29 : 14]) * 1e6 / (1 << 20);
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
  Eigen::MatrixXd product(x.cols(), y.cols());
  product.noalias() = x.transpose() * y;
  parallel::sum(comm, product);
  return product;
}

}  // namespace ricochet::modes
