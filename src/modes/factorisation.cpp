#include "src/modes/factorisation.hpp"

namespace ricochet::modes {

using parallel::check;

void require_inertia(Mat factor) { check(MatMumpsSetIcntl(factor, 13, 1)); }

Factorisation::Factorisation(Mat stiffness, Mat mass, double sigma) {
  check(MatDuplicate(stiffness, MAT_COPY_VALUES, shifted_.out()));
  // Not SAME_NONZERO_PATTERN: for MPISBAIJ with blocks PETSc 3.18 then adds the first nz of nz·bs² values
  // only.
  check(MatAXPY(shifted_, -sigma, mass, SUBSET_NONZERO_PATTERN));
  check(MatSetOption(shifted_, MAT_SYMMETRIC, PETSC_TRUE));
  check(MatGetFactor(shifted_, MATSOLVERMUMPS, MAT_FACTOR_CHOLESKY, factor_.out()));
  require_inertia(factor_);
  MatFactorInfo info;
  check(MatFactorInfoInitialize(&info));
  check(MatCholeskyFactorSymbolic(factor_, shifted_, nullptr, &info));
  check(MatCholeskyFactorNumeric(factor_, shifted_, &info));
  MatFactorError broken = MAT_FACTOR_NOERROR;
  check(MatFactorGetError(factor_, &broken));
  if (broken != MAT_FACTOR_NOERROR) {
    PetscInt code = 0;
    check(MatMumpsGetInfog(factor_, 1, &code));
    throw SolverError(
        "MUMPS could not factor K − σM (INFOG(1) = " + std::to_string(code) +
        (code == -9 || code == -13 ? "): not enough memory, use more ranks or a coarser mesh" : ")"));
  }
  PetscInt negative = 0;
  check(MatGetInertia(factor_, &negative, nullptr, nullptr));
  below_ = negative;
}

Eigen::MatrixXd Factorisation::solve(const Eigen::MatrixXd& right) const {
  MPI_Comm comm = MPI_COMM_NULL;
  check(PetscObjectGetComm(reinterpret_cast<PetscObject>(static_cast<Mat>(shifted_)), &comm));
  const auto n = static_cast<PetscInt>(right.cols());
  Eigen::MatrixXd solution(right.rows(), right.cols());
  if (n == 0) return solution;
  Eigen::MatrixXd copy = right;
  parallel::Matrix b, x;
  const auto local = static_cast<PetscInt>(right.rows());
  check(MatCreateDense(comm, local, PETSC_DECIDE, PETSC_DETERMINE, n, copy.data(), b.out()));
  check(MatCreateDense(comm, local, PETSC_DECIDE, PETSC_DETERMINE, n, solution.data(), x.out()));
  check(MatMatSolve(factor_, b, x));
  return solution;
}

Eigen::MatrixXd multiply(Mat matrix, const Eigen::MatrixXd& columns) {
  MPI_Comm comm = MPI_COMM_NULL;
  check(PetscObjectGetComm(reinterpret_cast<PetscObject>(matrix), &comm));
  Eigen::MatrixXd product(columns.rows(), columns.cols());
  const auto local = static_cast<PetscInt>(columns.rows());
  PetscInt block = 1;
  check(MatGetBlockSize(matrix, &block));
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    parallel::Vector x, y;
    check(VecCreateMPIWithArray(comm, block, local, PETSC_DECIDE, columns.col(j).data(), x.out()));
    check(VecCreateMPIWithArray(comm, block, local, PETSC_DECIDE, product.col(j).data(), y.out()));
    check(MatMult(matrix, x, y));
  }
  return product;
}

Eigen::MatrixXd inner(MPI_Comm comm, const Eigen::MatrixXd& x, const Eigen::MatrixXd& y) {
  Eigen::MatrixXd product = x.transpose() * y;
  parallel::sum(comm, product.data(), static_cast<std::size_t>(product.size()));
  return product;
}

}  // namespace ricochet::modes
