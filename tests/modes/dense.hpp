// SPDX-License-Identifier: BSD-2-Clause
// Dense oracles for small bodies: matrices gathered on every rank, and modes by LAPACK on one rank.
#pragma once

#include <Eigen/Core>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <vector>

#include "src/elasticity/assemble.hpp"
#include "src/modes/factorisation.hpp"

extern "C" void dsygvd_(const int* kind, const char* jobz, const char* uplo, const int* n, double* a,
                        const int* lda, double* b, const int* ldb, double* w, double* work, const int* lwork,
                        int* iwork, const int* liwork, int* info);

namespace ricochet::test {

inline double largest_entry(const Eigen::MatrixXd& x) { return x.size() > 0 ? x.cwiseAbs().maxCoeff() : 0; }

/// A X by PETSc, column by column. X and the result are (local rows, n).
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

/// K or M, complete on every rank, from the entries of the upper triangle that PETSc stores.
inline Eigen::MatrixXd dense(const mesh::Mesh& mesh, const elasticity::Body& body, Mat matrix) {
  const auto n = static_cast<Eigen::Index>(body.total_rows);
  const auto first = static_cast<PetscInt>(mesh.first_node * mesh.components());
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(n, n);
  parallel::check(MatGetRowUpperTriangular(matrix));
  for (PetscInt row = first; row < first + static_cast<PetscInt>(body.local_rows); ++row) {
    PetscInt entries = 0;
    const PetscInt* column = nullptr;
    const double* value = nullptr;
    parallel::check(MatGetRow(matrix, row, &entries, &column, &value));
    for (PetscInt k = 0; k < entries; ++k)
      if (column[k] >= row) whole(row, column[k]) = whole(column[k], row) = value[k];
    parallel::check(MatRestoreRow(matrix, row, &entries, &column, &value));
  }
  parallel::check(MatRestoreRowUpperTriangular(matrix));
  parallel::sum(mesh.comm, whole);
  return whole;
}

/// Rows that no support holds. The diagonal of M is positive there.
inline std::vector<Eigen::Index> free_rows(const Eigen::MatrixXd& mass) {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < mass.rows(); ++i)
    if (mass(i, i) > 1e-6 * mass.diagonal().maxCoeff()) rows.push_back(i);
  return rows;
}

/// All modes of K φ = λ M φ, ascending. value (n), vector (n, n) with φᵀ M φ = 1 in each column.
struct DenseModes {
  Eigen::VectorXd value;
  Eigen::MatrixXd vector;

  DenseModes(MPI_Comm comm, Eigen::MatrixXd stiffness, Eigen::MatrixXd mass, bool vectors = true)
      : value(stiffness.rows()), vector(std::move(stiffness)) {
    int rank = 0;
    MPI_Comm_rank(comm, &rank);
    const int kind = 1, n = static_cast<int>(value.size()), room = 1 + 6 * n + 2 * n * n,
              integers = 3 + 5 * n;
    int info = 0;
    // One rank is faster than all ranks at once if there are few cores.
    if (rank == 0) {
      Eigen::VectorXd work(room);
      Eigen::VectorXi more(integers);
      dsygvd_(&kind, vectors ? "V" : "N", "U", &n, vector.data(), &n, mass.data(), &n, value.data(),
              work.data(), &room, more.data(), &integers, &info);
    }
    MPI_Bcast(&info, 1, MPI_INT, 0, comm);
    if (info != 0) throw std::runtime_error("LAPACK dsygvd fails");
    MPI_Bcast(value.data(), n, MPI_DOUBLE, 0, comm);
    if (vectors) MPI_Bcast(vector.data(), n * n, MPI_DOUBLE, 0, comm);
  }
};

/// All eigenvalues of a body on its free rows, ascending. Those of the same matrices are computed once.
inline Eigen::VectorXd dense_eigenvalues(const mesh::Mesh& mesh, const elasticity::Body& body) {
  static std::vector<std::tuple<Eigen::MatrixXd, Eigen::MatrixXd, Eigen::VectorXd>> known;
  const Eigen::MatrixXd stiffness = dense(mesh, body, body.stiffness), mass = dense(mesh, body, body.mass);
  for (const auto& [k, m, value] : known)
    if (k.rows() == stiffness.rows() && k == stiffness && m == mass) return value;
  const std::vector<Eigen::Index> rows = free_rows(mass);
  const Eigen::VectorXd value = DenseModes(mesh.comm, stiffness(rows, rows), mass(rows, rows), false).value;
  known.emplace_back(stiffness, mass, value);
  return value;
}

}  // namespace ricochet::test
