// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/symmetric.hpp"

#include <vector>

#include "ricochet/error.hpp"

extern "C" void dsyevd_(const char* job, const char* triangle, const int* n, double* a, const int* lda,
                        double* w, double* work, const int* work_size, int* whole, const int* whole_size,
                        int* status);

namespace ricochet::modes {

Eigen::VectorXd eigen_decomposition(Eigen::MatrixXd& matrix) {
  Eigen::VectorXd values(matrix.rows());
  const auto n = static_cast<int>(matrix.rows());
  int status = 0;
  const int work_size = 1 + 6 * n + 2 * n * n, whole_size = 3 + 5 * n;
  std::vector<double> work(static_cast<std::size_t>(work_size));
  std::vector<int> whole(static_cast<std::size_t>(whole_size));
  dsyevd_("V", "L", &n, matrix.data(), &n, values.data(), work.data(), &work_size, whole.data(), &whole_size,
          &status);
  if (status != 0) throw SolverError("modes: the projected eigenproblem did not converge");
  return values;
}

}  // namespace ricochet::modes
