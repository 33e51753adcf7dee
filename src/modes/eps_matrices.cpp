// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/eps_matrices.hpp"

#include <algorithm>
#include <optional>
#include <vector>

namespace ricochet::modes {

namespace {

using parallel::check;

/// The rows of a matrix, converted to AIJ.
class Rows {
 public:
  explicit Rows(Mat matrix) {
    if (matrix == nullptr) return;
    check(MatConvert(matrix, MATAIJ, MAT_INITIAL_MATRIX, matrix_.out()));
    given_ = true;
  }
  /// Calls visit(column, value) for the entries of a row; those of the identity if no matrix was given.
  template <class Visit>
  void each(PetscInt row, const Visit& visit) const {
    if (!given_) return visit(row, 1.0);
    PetscInt n = 0;
    const PetscInt* column = nullptr;
    const double* value = nullptr;
    check(MatGetRow(matrix_, row, &n, &column, &value));
    for (PetscInt k = 0; k < n; ++k) visit(column[k], value[k]);
    check(MatRestoreRow(matrix_, row, &n, &column, &value));
  }

 private:
  parallel::Matrix matrix_;
  bool given_ = false;
};

PetscInt block_of(Mat matrix) {
  PetscInt block = 1;
  if (matrix != nullptr) check(MatGetBlockSize(matrix, &block));
  return block;
}

}  // namespace

Pair paired(Mat given_stiffness, Mat given_mass, double origin) {
  const Rows stiffness(given_stiffness), mass(given_mass);
  const bool blocked = block_of(given_stiffness) == 3 && (given_mass == nullptr || block_of(given_mass) == 3);
  const PetscInt block = blocked ? 3 : 1;
  PetscInt first = 0, behind = 0, total = 0;
  check(MatGetOwnershipRange(given_stiffness, &first, &behind));
  check(MatGetSize(given_stiffness, &total, nullptr));
  MPI_Comm comm = MPI_COMM_NULL;
  check(PetscObjectGetComm(reinterpret_cast<PetscObject>(given_stiffness), &comm));

  // Block columns of each block row, from the diagonal on.
  std::vector<std::vector<PetscInt>> columns(static_cast<std::size_t>((behind - first) / block));
  std::vector<PetscInt> own(columns.size(), 0), of_others(columns.size(), 0);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const PetscInt row = first / block + static_cast<PetscInt>(i);
    std::vector<PetscInt>& here = columns[i];
    here.push_back(row);
    for (PetscInt r = row * block; r < (row + 1) * block; ++r)
      for (const Rows* matrix : {&stiffness, &mass})
        matrix->each(r, [&](PetscInt column, double) {
          if (column / block > row) here.push_back(column / block);
        });
    std::ranges::sort(here);
    here.erase(std::unique(here.begin(), here.end()), here.end());
    for (const PetscInt column : here) ++(column < behind / block ? own : of_others)[i];
  }

  Pair pair;
  for (parallel::Matrix* made : {&pair.stiffness, &pair.mass}) {
    check(MatCreateSBAIJ(comm, block, behind - first, behind - first, total, total, 0, own.data(), 0,
                         of_others.data(), made->out()));
    check(MatSetOption(*made, MAT_IGNORE_LOWER_TRIANGULAR, PETSC_TRUE));
  }
  std::vector<double> of_stiffness, of_mass;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const PetscInt row = first / block + static_cast<PetscInt>(i);
    const std::vector<PetscInt>& here = columns[i];
    const std::size_t width = here.size() * static_cast<std::size_t>(block);
    of_stiffness.assign(static_cast<std::size_t>(block) * width, 0);
    of_mass.assign(of_stiffness.size(), 0);
    for (PetscInt r = 0; r < block; ++r) {
      const auto place = [&](PetscInt column) -> std::optional<std::size_t> {
        const auto at = std::ranges::lower_bound(here, column / block);
        if (at == here.end() || *at != column / block) return {};  // below the diagonal
        return static_cast<std::size_t>(r) * width +
               static_cast<std::size_t>((at - here.begin()) * block + column % block);
      };
      stiffness.each(row * block + r, [&](PetscInt column, double value) {
        if (const auto at = place(column)) of_stiffness[*at] += value;
      });
      mass.each(row * block + r, [&](PetscInt column, double value) {
        if (const auto at = place(column)) {
          of_mass[*at] += value;
          of_stiffness[*at] -= origin * value;
        }
      });
    }
    const auto n = static_cast<PetscInt>(here.size());
    check(MatSetValuesBlocked(pair.stiffness, 1, &row, n, here.data(), of_stiffness.data(), INSERT_VALUES));
    check(MatSetValuesBlocked(pair.mass, 1, &row, n, here.data(), of_mass.data(), INSERT_VALUES));
  }
  for (Mat made : {static_cast<Mat>(pair.stiffness), static_cast<Mat>(pair.mass)}) {
    check(MatAssemblyBegin(made, MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(made, MAT_FINAL_ASSEMBLY));
  }
  return pair;
}

}  // namespace ricochet::modes
