// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/symmetric.hpp"

#include <vector>

#include "ricochet/error.hpp"
#include "src/parallel/parallel.hpp"

extern "C" {
void dsyevd_(const char* job, const char* triangle, const int* n, double* a, const int* lda, double* w,
             double* work, const int* work_size, int* whole, const int* whole_size, int* status);
void dsygvd_(const int* type, const char* job, const char* triangle, const int* n, double* a, const int* lda,
             double* b, const int* ldb, double* w, double* work, const int* work_size, int* whole,
             const int* whole_size, int* status);
}

namespace ricochet::modes {

namespace {

constexpr const char* not_converged = "modes: a dense eigenproblem did not converge";

/// Calls `solve` with the eigenvalues, the workspace of a divide-and-conquer solver, and its status.
template <class Solve>
Eigen::VectorXd decomposition(Eigen::Index rows, const Solve& solve) {
  Eigen::VectorXd values(rows);
  const auto n = static_cast<int>(rows);
  int status = 0;
  const int work_size = 1 + 6 * n + 2 * n * n, whole_size = 3 + 5 * n;
  std::vector<double> work(static_cast<std::size_t>(work_size));
  std::vector<int> whole(static_cast<std::size_t>(whole_size));
  solve(n, values.data(), work.data(), work_size, whole.data(), whole_size, status);
  if (status != 0) throw SolverError(not_converged);
  return values;
}

Eigen::VectorXd on_this_rank(Eigen::MatrixXd& matrix) {
  return decomposition(matrix.rows(), [&](int n, double* values, double* work, int work_size, int* whole,
                                          int whole_size, int& status) {
    dsyevd_("V", "L", &n, matrix.data(), &n, values, work, &work_size, whole, &whole_size, &status);
  });
}

}  // namespace

Eigen::VectorXd eigen_decomposition(MPI_Comm comm, Eigen::MatrixXd& matrix) {
  if (parallel::size_of(comm) == 1) return on_this_rank(matrix);
  Eigen::VectorXd values;
  int converged = 1;
  if (parallel::rank_of(comm) == 0) try {
      values = on_this_rank(matrix);
    } catch (const SolverError&) {
      converged = 0;
    }
  MPI_Bcast(&converged, 1, MPI_INT, 0, comm);
  if (converged == 0) throw SolverError(not_converged);
  values.resize(matrix.rows());
  MPI_Bcast(values.data(), static_cast<int>(values.size()), MPI_DOUBLE, 0, comm);
  MPI_Bcast(matrix.data(), static_cast<int>(matrix.size()), MPI_DOUBLE, 0, comm);
  return values;
}

Eigen::VectorXd eigen_decomposition(Eigen::MatrixXd& a, Eigen::MatrixXd& b) {
  return decomposition(a.rows(), [&](int n, double* values, double* work, int work_size, int* whole,
                                     int whole_size, int& status) {
    const int type = 1;
    dsygvd_(&type, "V", "L", &n, a.data(), &n, b.data(), &n, values, work, &work_size, whole, &whole_size,
            &status);
  });
}

}  // namespace ricochet::modes
