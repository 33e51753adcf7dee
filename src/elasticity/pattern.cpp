// SPDX-License-Identifier: BSD-2-Clause
#include "src/elasticity/pattern.hpp"

#include <algorithm>

#include "src/elasticity/assemble.hpp"

namespace ricochet::elasticity {

namespace {

/// Returns e_i × x.
Vector3 cross_unit(int i, const Vector3& x) {
  if (i == 0) return {0, -x[2], x[1]};
  if (i == 1) return {x[2], 0, -x[0]};
  return {-x[1], x[0], 0};
}

}  // namespace

void append_row(Pattern& pattern, const mesh::Mesh& mesh, const std::vector<std::int64_t>& columns) {
  const auto inside =
      std::lower_bound(columns.begin(), columns.end(), mesh.first_node + mesh.owned_nodes) - columns.begin();
  pattern.diagonal.push_back(static_cast<PetscInt>(inside));
  pattern.off_diagonal.push_back(static_cast<PetscInt>(std::ssize(columns) - inside));
}

parallel::Matrix create(const mesh::Mesh& mesh, const Pattern& pattern) {
  parallel::Matrix matrix;
  const int c = mesh.components();
  parallel::check(MatCreate(mesh.comm, matrix.out()));
  const PetscInt local = parallel::petsc_int(mesh.owned_nodes * c),
                 total = parallel::petsc_int(mesh.total_nodes * c);
  parallel::check(MatSetSizes(matrix, local, local, total, total));
  parallel::check(MatSetType(matrix, MATSBAIJ));
  parallel::check(MatSetBlockSize(matrix, c));
  parallel::check(MatXAIJSetPreallocation(matrix, c, nullptr, nullptr, pattern.diagonal.data(),
                                          pattern.off_diagonal.data()));
  parallel::check(MatSetOption(matrix, MAT_IGNORE_LOWER_TRIANGULAR, PETSC_TRUE));
  parallel::check(MatSetOption(matrix, MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_TRUE));
  parallel::check(MatSetOption(matrix, MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE));
  return matrix;
}

double rigid_value(const mesh::Mesh& mesh, int k, const Vector3& x, int c) {
  Vector3 u{};
  if (k < 3)
    u[k] = 1;
  else
    u = cross_unit(k - 3, x);
  if (mesh.dim == 3) return u[c];
  return u[0] * mesh.axis[0] + u[1] * mesh.axis[1] + u[2] * mesh.axis[2];
}

void finish_inertia(MPI_Comm comm, std::array<double, 10>& moments, Body& body) {
  parallel::sum(comm, moments);
  body.total_mass = moments[0];
  Eigen::Vector3d centre(moments[1], moments[2], moments[3]);
  centre /= moments[0];
  Eigen::Matrix3d second;
  second << moments[4], moments[5], moments[6], moments[5], moments[7], moments[8], moments[6], moments[8],
      moments[9];
  second -= moments[0] * centre * centre.transpose();
  const Eigen::Matrix3d inertia = second.trace() * Eigen::Matrix3d::Identity() - second;
  Eigen::Map<Eigen::Vector3d>(body.centre.data()) = centre;
  Eigen::Map<Eigen::Matrix3d>(body.inertia.data()) = inertia;
}

void finish_rows(const mesh::Mesh& mesh, double stiffest, Body& body) {
  const int c = mesh.components();
  // Any positive value serves on the diagonal of fixed rows; the largest diagonal entry preserves the
  // conditioning.
  stiffest = parallel::largest(mesh.comm, stiffest);
  std::int64_t fixed = 0;
  mesh.for_each_owned([&](std::size_t i, std::int64_t) {
    for (int k = 0; k < c; ++k)
      if (mesh.is_fixed(i, k)) {
        const auto row = static_cast<PetscInt>(mesh.node[i] * c + k);
        parallel::check(MatSetValue(body.stiffness, row, row, stiffest > 0 ? stiffest : 1.0, ADD_VALUES));
        ++fixed;
      }
  });
  body.free_rows = body.total_rows - parallel::sum(mesh.comm, fixed);
  for (Mat matrix : {static_cast<Mat>(body.stiffness), static_cast<Mat>(body.mass)}) {
    parallel::check(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
    parallel::check(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
  }
}

}  // namespace ricochet::elasticity
