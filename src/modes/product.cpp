#include "src/modes/product.hpp"

#include <algorithm>

namespace ricochet::modes {

namespace {

using parallel::check;

/// Columns that one pass over the matrix serves: a cache line of each row.
constexpr int width = 8;

/// y += A x, rows of x and y being `width` columns side by side. B: block size; D: blocks are diagonal and
/// all there, otherwise they are those of the upper triangle.
template <int B, bool D>
[[gnu::always_inline]] inline void accumulate(std::size_t rows, const PetscInt* start, const PetscInt* column,
                                              const double* value, const double* x, double* y) {
  constexpr int entries = D ? B : B * B;
  for (std::size_t i = 0; i < rows; ++i) {
    double own[B * width] = {};
    [[maybe_unused]] const double* xi = x + i * B * width;
    for (PetscInt k = start[i]; k < start[i + 1]; ++k) {
      const auto j = static_cast<std::size_t>(column[k]);
      const double *a = value + static_cast<std::size_t>(k) * entries, *xj = x + j * B * width;
      if constexpr (D) {
        for (int r = 0; r < B; ++r)
          for (int w = 0; w < width; ++w) own[r * width + w] += a[r] * xj[r * width + w];
      } else {
        double* yj = y + j * B * width;
        const bool off = j != i;
        for (int r = 0; r < B; ++r)
          for (int c = 0; c < B; ++c) {
            for (int w = 0; w < width; ++w) own[r * width + w] += a[c * B + r] * xj[c * width + w];
            if (off)
              for (int w = 0; w < width; ++w) yj[c * width + w] += a[c * B + r] * xi[r * width + w];
          }
      }
    }
    for (int w = 0; w < B * width; ++w) y[i * B * width + static_cast<std::size_t>(w)] += own[w];
  }
}

// One body compiled for each instruction set: the packages of a distribution are built for the oldest.
#define RICOCHET_PRODUCT(name, B, D)                                                                         \
  __attribute__((target_clones("arch=x86-64-v4", "avx2", "default"))) void name(                             \
      std::size_t rows, const PetscInt* start, const PetscInt* column, const double* value, const double* x, \
      double* y) {                                                                                           \
    accumulate<B, D>(rows, start, column, value, x, y);                                                      \
  }
RICOCHET_PRODUCT(full_blocks, 3, false)
RICOCHET_PRODUCT(diagonal_blocks, 3, true)
RICOCHET_PRODUCT(scalars, 1, true)
#undef RICOCHET_PRODUCT

}  // namespace

BlockProduct::BlockProduct(Mat matrix) : matrix_(matrix) {
  MPI_Comm comm = MPI_COMM_NULL;
  check(PetscObjectGetComm(reinterpret_cast<PetscObject>(matrix), &comm));
  check(MatGetBlockSize(matrix, &block_));
  serial_ = parallel::size_of(comm) == 1 && (block_ == 1 || block_ == 3);
  if (!serial_) return;
  PetscInt rows = 0;
  const PetscInt *start = nullptr, *column = nullptr;
  PetscBool done = PETSC_FALSE;
  check(MatGetRowIJ(matrix, 0, PETSC_FALSE, PETSC_TRUE, &rows, &start, &column, &done));
  if (!done) throw SolverError("internal: the matrix does not show its rows");
  start_.assign(start, start + rows + 1);
  column_.assign(column, column + start[rows]);
  check(MatRestoreRowIJ(matrix, 0, PETSC_FALSE, PETSC_TRUE, &rows, &start, &column, &done));
  double* value = nullptr;
  check(MatSeqSBAIJGetArray(matrix, &value));
  const auto entries = static_cast<std::size_t>(block_ * block_);
  const std::size_t size = column_.size() * entries;
  diagonal_ = true;
  for (std::size_t k = 0; k < size && diagonal_; ++k)
    diagonal_ = (k % entries) % static_cast<std::size_t>(block_ + 1) == 0 || value[k] == 0;
  if (diagonal_) {
    take_diagonals(value, entries);
  } else {
    value_.assign(value, value + size);
  }
  check(MatSeqSBAIJRestoreArray(matrix, &value));
}

void BlockProduct::take_diagonals(const double* upper, std::size_t entries) {
  const std::size_t rows = start_.size() - 1;
  const auto block = static_cast<std::size_t>(block_);
  // Upper and lower triangle: rows are then summed up without touching others.
  std::vector<PetscInt> start(rows + 1, 0), next;
  for (std::size_t i = 0; i < rows; ++i)
    for (PetscInt k = start_[i]; k < start_[i + 1]; ++k) {
      const auto j = static_cast<std::size_t>(column_[static_cast<std::size_t>(k)]);
      ++start[i + 1];
      if (j != i) ++start[j + 1];
    }
  for (std::size_t i = 0; i < rows; ++i) start[i + 1] += start[i];
  next.assign(start.begin(), start.end() - 1);
  std::vector<PetscInt> column(static_cast<std::size_t>(start.back()));
  value_.resize(column.size() * block);
  const auto put = [&](std::size_t i, std::size_t j, const double* entry) {
    const auto at = static_cast<std::size_t>(next[i]++);
    column[at] = static_cast<PetscInt>(j);
    for (std::size_t d = 0; d < block; ++d) value_[at * block + d] = entry[d * (block + 1)];
  };
  for (std::size_t i = 0; i < rows; ++i)
    for (PetscInt k = start_[i]; k < start_[i + 1]; ++k) {
      const auto j = static_cast<std::size_t>(column_[static_cast<std::size_t>(k)]);
      const double* entry = upper + static_cast<std::size_t>(k) * entries;
      put(i, j, entry);
      if (j != i) put(j, i, entry);
    }
  start_ = std::move(start);
  column_ = std::move(column);
}

Eigen::MatrixXd BlockProduct::operator()(const Eigen::Ref<const Eigen::MatrixXd>& columns) const {
  Eigen::MatrixXd product(columns.rows(), columns.cols());
  if (!serial_) {
    MPI_Comm comm = MPI_COMM_NULL;
    check(PetscObjectGetComm(reinterpret_cast<PetscObject>(matrix_), &comm));
    const auto local = static_cast<PetscInt>(columns.rows());
    for (Eigen::Index j = 0; j < columns.cols(); ++j) {
      parallel::Vector x, y;
      check(VecCreateMPIWithArray(comm, block_, local, PETSC_DECIDE, columns.col(j).data(), x.out()));
      check(VecCreateMPIWithArray(comm, block_, local, PETSC_DECIDE, product.col(j).data(), y.out()));
      check(MatMult(matrix_, x, y));
    }
    return product;
  }
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, width, Eigen::RowMajor>;
  Rows x(columns.rows(), width), y(columns.rows(), width);
  const auto kernel = block_ == 1 ? scalars : diagonal_ ? diagonal_blocks : full_blocks;
  for (Eigen::Index j = 0; j < columns.cols(); j += width) {
    const Eigen::Index n = std::min<Eigen::Index>(width, columns.cols() - j);
    if (n < width) x.setZero();
    x.leftCols(n) = columns.middleCols(j, n);
    y.setZero();
    kernel(start_.size() - 1, start_.data(), column_.data(), value_.data(), x.data(), y.data());
    product.middleCols(j, n) = y.leftCols(n);
  }
  return product;
}

}  // namespace ricochet::modes
