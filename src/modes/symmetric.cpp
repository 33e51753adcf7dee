// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/symmetric.hpp"

#include <vector>

#include "ricochet/error.hpp"

extern "C" {
void dsyevd_(const char* job, const char* triangle, const int* n, double* a, const int* lda, double* w,
             double* work, const int* work_size, int* whole, const int* whole_size, int* status);
void dsygvd_(const int* type, const char* job, const char* triangle, const int* n, double* a, const int* lda,
             double* b, const int* ldb, double* w, double* work, const int* work_size, int* whole,
             const int* whole_size, int* status);
}

namespace ricochet::modes {

namespace {

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
  if (status != 0) throw SolverError("modes: a dense eigenproblem did not converge");
  return values;
}

}  // namespace

Eigen::VectorXd eigen_decomposition(Eigen::MatrixXd& matrix) {
  return decomposition(matrix.rows(), [&](int n, double* values, double* work, int work_size, int* whole,
                                          int whole_size, int& status) {
    dsyevd_("V", "L", &n, matrix.data(), &n, values, work, &work_size, whole, &whole_size, &status);
  });
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
