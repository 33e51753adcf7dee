// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/product.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace ricochet::modes {

namespace {

using parallel::check;

/// Number of columns per pass over the matrix; they fill one cache line in each row.
constexpr int width = 8;

/// Computes y += A x. Each row of x and y has `width` columns side by side.
/// @tparam B  block size
/// @tparam D  whether blocks are diagonal; complete rows are then stored, except for the rows of ghosts.
/// Otherwise, the upper triangle is stored.
template <int B, bool D>
[[gnu::always_inline]] inline void accumulate(std::size_t rows, const PetscInt* start, const PetscInt* column,
                                              const double* value, const double* x, double* y) {
  constexpr int entries = D ? B : B * B;
  for (std::size_t i = 0; i < rows; ++i) {
    double own[B * width] = {};
    const double* xi = x + i * B * width;
    for (PetscInt k = start[i]; k < start[i + 1]; ++k) {
      const auto j = static_cast<std::size_t>(column[k]);
      const double *a = value + static_cast<std::size_t>(k) * entries, *xj = x + j * B * width;
      if constexpr (D) {
        for (int r = 0; r < B; ++r)
          for (int w = 0; w < width; ++w) own[r * width + w] += a[r] * xj[r * width + w];
        if (j < rows) continue;
        double* yj = y + j * B * width;
        for (int r = 0; r < B; ++r)
          for (int w = 0; w < width; ++w) yj[r * width + w] += a[r] * xi[r * width + w];
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

// Compiles one function body for several instruction sets, because packages of a distribution are built for
// the oldest one.
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

/// A graph with each edge at both ends.
struct Graph {
  std::vector<std::size_t> start, neighbour;
};

/// Returns the nodes in the order of a breadth-first search that begins far from the middle.
std::vector<std::size_t> breadth_first(const Graph& graph) {
  const std::size_t nodes = graph.start.size() - 1;
  std::vector<std::size_t> order;
  std::vector<std::size_t> reached(nodes, 0);  // number of the last search that reached a node
  const auto search = [&](std::size_t from, std::size_t number) {
    std::size_t at = order.size();
    order.push_back(from);
    reached[from] = number;
    for (; at < order.size(); ++at)
      for (std::size_t k = graph.start[order[at]]; k < graph.start[order[at] + 1]; ++k)
        if (const std::size_t node = graph.neighbour[k]; reached[node] != number) {
          reached[node] = number;
          order.push_back(node);
        }
  };
  for (std::size_t seed = 0; seed < nodes; ++seed) {
    if (reached[seed] != 0) continue;
    const std::size_t before = order.size();
    search(seed, 1);
    const std::size_t farthest = order.back();
    order.resize(before);
    search(farthest, 2);
  }
  return order;
}

}  // namespace

BlockProduct::BlockProduct(Mat matrix) {
  const MPI_Comm comm = parallel::comm_of(matrix);
  check(MatGetBlockSize(matrix, &block_));
  if (block_ != 1 && block_ != 3) throw SolverError("internal: products are for blocks of 1 and 3");
  take_blocks(matrix);
  const PetscInt* range = nullptr;
  check(MatGetOwnershipRanges(matrix, &range));
  const std::vector<PetscInt> ghost = number_ghosts(range, parallel::rank_of(comm));
  reorder();
  several_ = parallel::size_of(comm) > 1;
  if (several_) connect(comm, range, ghost);
  const auto entries = static_cast<std::size_t>(block_ * block_);
  diagonal_ = true;
  for (std::size_t k = 0; k < value_.size() && diagonal_; ++k)
    diagonal_ = (k % entries) % static_cast<std::size_t>(block_ + 1) == 0 || value_[k] == 0;
  // All ranks must use the same variant of the product.
  int all = diagonal_ ? 1 : 0;
  MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPI_INT, MPI_MIN, comm);
  diagonal_ = all == 1;
  if (diagonal_) take_diagonals();
}

void BlockProduct::take_blocks(Mat matrix) {
  PetscInt first = 0, end = 0;
  check(MatGetOwnershipRange(matrix, &first, &end));
  rows_ = static_cast<std::size_t>((end - first) / block_);
  start_.assign(1, 0);
  check(MatGetRowUpperTriangular(matrix));
  for (PetscInt i = first; i < end; i += block_) {
    for (PetscInt r = 0; r < block_; ++r) {
      PetscInt n = 0;
      const PetscInt* column = nullptr;
      const double* entry = nullptr;
      check(MatGetRow(matrix, i + r, &n, &column, &entry));
      // Every row of a block row starts at the first column of its first block, even within the diagonal
      // block.
      const PetscInt blocks = n / block_;
      if (r == 0) {
        start_.push_back(start_.back() + blocks);
        for (PetscInt k = 0; k < blocks; ++k) column_.push_back(column[k * block_] / block_);
        value_.resize(column_.size() * static_cast<std::size_t>(block_ * block_));
      }
      const auto at = static_cast<std::size_t>(start_[start_.size() - 2]);
      for (PetscInt k = 0; k < n; ++k)
        value_[(at + static_cast<std::size_t>(k / block_)) * static_cast<std::size_t>(block_ * block_) +
               static_cast<std::size_t>((k % block_) * block_ + r)] = entry[k];
      check(MatRestoreRow(matrix, i + r, &n, &column, &entry));
    }
  }
  check(MatRestoreRowUpperTriangular(matrix));
}

std::vector<PetscInt> BlockProduct::number_ghosts(const PetscInt* range, int rank) {
  const PetscInt first = range[rank] / block_, end = range[rank + 1] / block_;
  std::vector<PetscInt> ghost;
  for (const PetscInt column : column_)
    if (column < first || column >= end) ghost.push_back(column);
  std::sort(ghost.begin(), ghost.end());
  ghost.erase(std::unique(ghost.begin(), ghost.end()), ghost.end());
  ghosts_ = ghost.size();
  for (PetscInt& column : column_) {
    const bool own = column >= first && column < end;
    column =
        own ? column - first
            : static_cast<PetscInt>(rows_) +
                  static_cast<PetscInt>(std::lower_bound(ghost.begin(), ghost.end(), column) - ghost.begin());
  }
  return ghost;
}

void BlockProduct::reorder() {
  const auto entries = static_cast<std::size_t>(block_ * block_);
  const auto each = [&](const auto& visit) {
    for (std::size_t i = 0; i < rows_; ++i)
      for (PetscInt k = start_[i]; k < start_[i + 1]; ++k)
        visit(i, static_cast<std::size_t>(column_[static_cast<std::size_t>(k)]), static_cast<std::size_t>(k));
  };
  Graph graph{std::vector<std::size_t>(rows_ + 1), {}};
  each([&](std::size_t i, std::size_t j, std::size_t) {
    if (j == i || j >= rows_) return;
    ++graph.start[i + 1];
    ++graph.start[j + 1];
  });
  std::partial_sum(graph.start.begin(), graph.start.end(), graph.start.begin());
  graph.neighbour.resize(graph.start.back());
  std::vector<std::size_t> next(graph.start.begin(), graph.start.end() - 1);
  each([&](std::size_t i, std::size_t j, std::size_t) {
    if (j == i || j >= rows_) return;
    graph.neighbour[next[i]++] = j;
    graph.neighbour[next[j]++] = i;
  });
  place_.resize(rows_);
  PetscInt place = 0;
  for (const std::size_t row : breadth_first(graph)) place_[row] = place++;

  // Moves the blocks. One that would come below the diagonal is transposed.
  const auto moved = [&](std::size_t i, std::size_t j) {
    const PetscInt to = place_[i], column = j < rows_ ? place_[j] : static_cast<PetscInt>(j);
    return column < to ? std::pair(column, to) : std::pair(to, column);
  };
  std::vector<PetscInt> start(rows_ + 1), column(column_.size());
  std::vector<double> value(value_.size());
  each([&](std::size_t i, std::size_t j, std::size_t) {
    ++start[static_cast<std::size_t>(moved(i, j).first) + 1];
  });
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<PetscInt> free(start.begin(), start.end() - 1);
  each([&](std::size_t i, std::size_t j, std::size_t k) {
    const auto [row, col] = moved(i, j);
    const auto at = static_cast<std::size_t>(free[static_cast<std::size_t>(row)]++);
    column[at] = col;
    using Block = Eigen::Map<Eigen::MatrixXd>;
    Block to(value.data() + at * entries, block_, block_);
    to = Block(value_.data() + k * entries, block_, block_);
    if (row != place_[i]) to.transposeInPlace();
  });
  start_ = std::move(start);
  column_ = std::move(column);
  value_ = std::move(value);
}

void BlockProduct::connect(MPI_Comm comm, const PetscInt* range, const std::vector<PetscInt>& ghost) {
  row_ = parallel::RowType(static_cast<int>(block_) * width);
  std::vector<PetscSFNode> owner;
  int at = 0;
  for (const PetscInt g : ghost) {
    while (g >= range[at + 1] / block_) ++at;
    owner.push_back({at, g - range[at] / block_});
  }
  const auto set_graph = [&] {
    check(PetscSFSetGraph(exchange_, static_cast<PetscInt>(rows_), static_cast<PetscInt>(ghosts_), nullptr,
                          PETSC_COPY_VALUES, owner.data(), PETSC_COPY_VALUES));
    check(PetscSFSetUp(exchange_));
  };
  check(PetscSFCreate(comm, exchange_.out()));
  set_graph();
  // The owners know the places of their rows.
  std::vector<PetscInt> place(ghosts_);
  check(PetscSFBcastBegin(exchange_, MPIU_INT, place_.data(), place.data(), MPI_REPLACE));
  check(PetscSFBcastEnd(exchange_, MPIU_INT, place_.data(), place.data(), MPI_REPLACE));
  for (std::size_t g = 0; g < ghosts_; ++g) owner[g].index = place[g];
  check(PetscSFReset(exchange_));
  set_graph();
}

void BlockProduct::take_diagonals() {
  const auto block = static_cast<std::size_t>(block_), entries = block * block;
  const std::vector<double> upper = std::move(value_);
  const std::vector<PetscInt> start_of = std::move(start_), column_of = std::move(column_);
  // Stores the upper and the lower triangle, so that a row is summed without writing to other rows, except to
  // ghosts.
  start_.assign(rows_ + 1, 0);
  const auto each = [&](const auto& visit) {
    for (std::size_t i = 0; i < rows_; ++i)
      for (PetscInt k = start_of[i]; k < start_of[i + 1]; ++k) {
        const auto j = static_cast<std::size_t>(column_of[static_cast<std::size_t>(k)]);
        const double* entry = upper.data() + static_cast<std::size_t>(k) * entries;
        visit(i, j, entry);
        if (j != i && j < rows_) visit(j, i, entry);
      }
  };
  each([&](std::size_t i, std::size_t, const double*) { ++start_[i + 1]; });
  for (std::size_t i = 0; i < rows_; ++i) start_[i + 1] += start_[i];
  std::vector<PetscInt> next(start_.begin(), start_.end() - 1);
  column_.resize(static_cast<std::size_t>(start_.back()));
  value_.resize(column_.size() * block);
  each([&](std::size_t i, std::size_t j, const double* entry) {
    const auto at = static_cast<std::size_t>(next[i]++);
    column_[at] = static_cast<PetscInt>(j);
    for (std::size_t d = 0; d < block; ++d) value_[at * block + d] = entry[d * (block + 1)];
  });
}

Eigen::MatrixXd BlockProduct::operator()(const Eigen::Ref<const Eigen::MatrixXd>& columns) const {
  Eigen::MatrixXd product(columns.rows(), columns.cols());
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, width, Eigen::RowMajor>;
  const Eigen::Index own = columns.rows(), ghosts = static_cast<Eigen::Index>(ghosts_) * block_;
  Rows x(own + ghosts, width), y(own + ghosts, width);
  const auto each_row = [&](const auto& visit) {
    for (std::size_t i = 0; i < rows_; ++i)
      for (Eigen::Index c = 0; c < block_; ++c)
        visit(static_cast<Eigen::Index>(i) * block_ + c, place_[i] * block_ + c);
  };
  const auto kernel = block_ == 1 ? scalars : diagonal_ ? diagonal_blocks : full_blocks;
  for (Eigen::Index j = 0; j < columns.cols(); j += width) {
    const Eigen::Index n = std::min<Eigen::Index>(width, columns.cols() - j);
    if (n < width) x.setZero();
    each_row([&](Eigen::Index from, Eigen::Index to) {
      for (Eigen::Index w = 0; w < n; ++w) x(to, w) = columns(from, j + w);
    });
    y.setZero();
    if (several_) check(PetscSFBcastBegin(exchange_, row_, x.data(), x.data() + own * width, MPI_REPLACE));
    if (several_) check(PetscSFBcastEnd(exchange_, row_, x.data(), x.data() + own * width, MPI_REPLACE));
    kernel(rows_, start_.data(), column_.data(), value_.data(), x.data(), y.data());
    if (several_) check(PetscSFReduceBegin(exchange_, row_, y.data() + own * width, y.data(), MPI_SUM));
    if (several_) check(PetscSFReduceEnd(exchange_, row_, y.data() + own * width, y.data(), MPI_SUM));
    each_row([&](Eigen::Index from, Eigen::Index to) {
      for (Eigen::Index w = 0; w < n; ++w) product(from, j + w) = y(to, w);
    });
  }
  return product;
}

}  // namespace ricochet::modes
