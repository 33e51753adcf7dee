// Dense oracles for small bodies: the matrices gathered on every rank, eigenvalues by LAPACK-like Eigen.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <vector>

#include "src/elasticity/assemble.hpp"
#include "src/modes/factorisation.hpp"

namespace ricochet::test {

inline double largest_entry(const Eigen::MatrixXd& x) { return x.size() > 0 ? x.cwiseAbs().maxCoeff() : 0; }

/// A X by PETSc, column by column. X (local rows, n), result likewise.
inline Eigen::MatrixXd product(Mat matrix, const Eigen::MatrixXd& columns) {
  MPI_Comm comm = MPI_COMM_NULL;
  parallel::check(PetscObjectGetComm(reinterpret_cast<PetscObject>(matrix), &comm));
  Eigen::MatrixXd result(columns.rows(), columns.cols());
  const auto local = static_cast<PetscInt>(columns.rows());
  PetscInt block = 1;
  parallel::check(MatGetBlockSize(matrix, &block));
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    parallel::Vector x, y;
    parallel::check(VecCreateMPIWithArray(comm, block, local, PETSC_DECIDE, columns.col(j).data(), x.out()));
    parallel::check(VecCreateMPIWithArray(comm, block, local, PETSC_DECIDE, result.col(j).data(), y.out()));
    parallel::check(MatMult(matrix, x, y));
  }
  return result;
}

/// K or M whole on every rank, by products with unit vectors.
inline Eigen::MatrixXd dense(const mesh::Mesh& mesh, const elasticity::Body& body, Mat matrix) {
  const Eigen::Index n = body.total_rows, first = mesh.first_node * mesh.components();
  Eigen::MatrixXd identity = Eigen::MatrixXd::Zero(body.local_rows, n);
  for (Eigen::Index i = 0; i < body.local_rows; ++i) identity(i, first + i) = 1;
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(n, n);
  whole.middleRows(first, body.local_rows) = product(matrix, identity);
  parallel::sum(mesh.comm, whole.data(), static_cast<std::size_t>(whole.size()));
  return whole;
}

/// Rows that no support holds: M has a positive diagonal there.
inline std::vector<Eigen::Index> free_rows(const Eigen::MatrixXd& mass) {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < mass.rows(); ++i)
    if (mass(i, i) > 1e-6 * mass.diagonal().maxCoeff()) rows.push_back(i);
  return rows;
}

/// All eigenvalues of K φ = λ M φ on the free rows, ascending.
inline Eigen::VectorXd dense_eigenvalues(const mesh::Mesh& mesh, const elasticity::Body& body) {
  const Eigen::MatrixXd stiffness = dense(mesh, body, body.stiffness), mass = dense(mesh, body, body.mass);
  const std::vector<Eigen::Index> rows = free_rows(mass);
  return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(stiffness(rows, rows), mass(rows, rows),
                                                                   Eigen::EigenvaluesOnly)
      .eigenvalues();
}

}  // namespace ricochet::test
