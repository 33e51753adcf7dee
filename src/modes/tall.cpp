// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/tall.hpp"

#include <algorithm>
#include <vector>

#include "base/processor.hpp"

namespace ricochet::modes {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using ConstMatrix = Eigen::Ref<const MatrixXd>;

/// Rows of Y that are packed at a time; they fit into the cache of the second level.
constexpr Index chunk = 512;
/// Columns of Q per pass over a chunk in a subtraction. More would be more streams than processors prefetch.
constexpr Index streams = 16;

/// Columns of Y side by side: two vectors of a loops.
template <int Bytes>
struct Vector {
  // NOLINTNEXTLINE: the attribute needs a typedef
  typedef double Type __attribute__((vector_size(Bytes), aligned(8), may_alias));
};
template <int Bytes>
constexpr int numbers = 2 * Bytes / 8;

/// Copies vectors between memory and registers.
template <int Bytes, int Count>
[[gnu::always_inline]] inline void copy(const typename Vector<Bytes>::Type* from,
                                        typename Vector<Bytes>::Type* to) {
#pragma GCC unroll 32
  for (int k = 0; k < Count; ++k) to[k] = from[k];
}

/// Computes c += qᵀ y for some columns of Q.
/// @tparam K  number of columns of Q
/// @param y, c  rows of `numbers` numbers
template <int Bytes, int K>
[[gnu::always_inline]] inline void accumulate(Index rows, const double* q, Index stride, const double* y,
                                              double* c) {
  using V = typename Vector<Bytes>::Type;
  V sum[2 * K];
  V* to = reinterpret_cast<V*>(c);
  copy<Bytes, 2 * K>(to, sum);
  const V* from = reinterpret_cast<const V*>(y);
  for (Index i = 0; i < rows; ++i) {
#pragma GCC unroll 16
    for (int k = 0; k < K; ++k) {
      sum[2 * k] += q[k * stride + i] * from[2 * i];
      sum[2 * k + 1] += q[k * stride + i] * from[2 * i + 1];
    }
  }
  copy<Bytes, 2 * K>(sum, to);
}

/// Computes y −= q c for some rows of Q.
/// @tparam N  number of rows of Q
/// @param c, y  rows of `numbers` numbers
template <int Bytes, int N>
[[gnu::always_inline]] inline void reduce(Index columns, const double* q, Index stride, const double* c,
                                          double* y) {
  using V = typename Vector<Bytes>::Type;
  V rest[2 * N];
  V* to = reinterpret_cast<V*>(y);
  copy<Bytes, 2 * N>(to, rest);
  const V* from = reinterpret_cast<const V*>(c);
  for (Index k = 0; k < columns; ++k) {
#pragma GCC unroll 16
    for (int i = 0; i < N; ++i) {
      rest[2 * i] -= q[k * stride + i] * from[2 * k];
      rest[2 * i + 1] -= q[k * stride + i] * from[2 * k + 1];
    }
  }
  copy<Bytes, 2 * N>(rest, to);
}

/// Computes c += Qᵀ y for one chunk of rows, K columns of Q at a time.
template <int Bytes, int K>
[[gnu::always_inline]] inline void inner_of_chunk(Index rows, Index columns, const double* q, Index stride,
                                                  const double* y, double* c) {
  Index k = 0;
  for (; k + K <= columns; k += K)
    accumulate<Bytes, K>(rows, q + k * stride, stride, y, c + k * numbers<Bytes>);
  for (; k < columns; ++k) accumulate<Bytes, 1>(rows, q + k * stride, stride, y, c + k * numbers<Bytes>);
}

/// Computes y −= Q c for one chunk of rows, N rows at a time.
template <int Bytes, int N>
[[gnu::always_inline]] inline void subtract_in_chunk(Index rows, Index columns, const double* q, Index stride,
                                                     const double* c, double* y) {
  for (Index k = 0; k < columns; k += streams) {
    const Index n = std::min(streams, columns - k);
    const double *from = q + k * stride, *times = c + k * numbers<Bytes>;
    Index i = 0;
    for (; i + N <= rows; i += N) reduce<Bytes, N>(n, from + i, stride, times, y + i * numbers<Bytes>);
    for (; i < rows; ++i) reduce<Bytes, 1>(n, from + i, stride, times, y + i * numbers<Bytes>);
  }
}

#ifdef __x86_64__
// The number of columns or rows at a time is such that their sums fill at most three quarters of the
// registers.
// Compilers split the widest vectors in two unless they are told not to.
#ifdef __clang__
#define RICOCHET_WIDE(level) __attribute__((target("arch=" level), min_vector_width(512)))
#else
#define RICOCHET_WIDE(level) __attribute__((target("arch=" level ",prefer-vector-width=512")))
#endif
#define RICOCHET_TALL(name, function, bytes, count, level)                                             \
  RICOCHET_WIDE(level)                                                                                 \
  void name(Index rows, Index columns, const double* q, Index stride, const double* in, double* out) { \
    function<bytes, count>(rows, columns, q, stride, in, out);                                         \
  }
RICOCHET_TALL(inner_512, inner_of_chunk, 64, 12, "x86-64-v4")
RICOCHET_TALL(subtract_512, subtract_in_chunk, 64, 8, "x86-64-v4")
RICOCHET_TALL(inner_256, inner_of_chunk, 32, 6, "x86-64-v3")
RICOCHET_TALL(subtract_256, subtract_in_chunk, 32, 6, "x86-64-v3")
#undef RICOCHET_TALL
#undef RICOCHET_WIDE
#endif

/// Calls visit(first column, columns) for groups of columns that are treated at once.
template <class Visit>
void in_groups(Index columns, Index width_of_group, const Visit& visit) {
  for (Index j = 0; j < columns; j += width_of_group) visit(j, std::min(width_of_group, columns - j));
}

/// Largest number of columns for which a subtraction is faster than with BLAS.
constexpr Index narrow = 32;

using Packed = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace

std::span<const TallLoops> tall_loops() {
#ifdef __x86_64__
  static constexpr TallLoops all[] = {
      {}, {numbers<32>, inner_256, subtract_256}, {numbers<64>, inner_512, subtract_512}};
  const std::span<const TallLoops> loops(all);
  return loops.first(base::supports_avx512() ? 3 : base::supports_avx2() ? 2 : 1);
#else
  static constexpr TallLoops all[] = {{}};
  return all;
#endif
}

MatrixXd tall_inner(const ConstMatrix& q, const ConstMatrix& y, const TallLoops& loops) {
  MatrixXd product(q.cols(), y.cols());
  if (loops.width == 0) {
    product.noalias() = q.transpose() * y;
    return product;
  }
  const Index groups = (y.cols() + loops.width - 1) / loops.width;
  std::vector<Packed> sum(static_cast<std::size_t>(groups), Packed::Zero(q.cols(), loops.width));
  Packed rows = Packed::Zero(std::min(chunk, q.rows()), loops.width);
  for (Index i = 0; i < q.rows(); i += chunk) {
    const Index n = std::min(chunk, q.rows() - i);
    in_groups(y.cols(), loops.width, [&](Index j, Index columns) {
      rows.topLeftCorner(n, columns) = y.block(i, j, n, columns);
      loops.inner(n, q.cols(), q.data() + i, q.outerStride(), rows.data(),
                  sum[static_cast<std::size_t>(j / loops.width)].data());
    });
  }
  in_groups(y.cols(), loops.width, [&](Index j, Index columns) {
    product.middleCols(j, columns) = sum[static_cast<std::size_t>(j / loops.width)].leftCols(columns);
  });
  return product;
}

void tall_subtract(const ConstMatrix& q, const ConstMatrix& c, Eigen::Ref<MatrixXd> y,
                   const TallLoops& loops) {
  if (loops.width == 0 || y.cols() > narrow) {
    y.noalias() -= q * c;
    return;
  }
  Packed factor = Packed::Zero(c.rows(), loops.width);
  Packed rows = Packed::Zero(std::min(chunk, q.rows()), loops.width);
  in_groups(y.cols(), loops.width, [&](Index j, Index columns) {
    factor.leftCols(columns) = c.middleCols(j, columns);
    for (Index i = 0; i < q.rows(); i += chunk) {
      const Index n = std::min(chunk, q.rows() - i);
      rows.topLeftCorner(n, columns) = y.block(i, j, n, columns);
      loops.subtract(n, q.cols(), q.data() + i, q.outerStride(), factor.data(), rows.data());
      y.block(i, j, n, columns) = rows.topLeftCorner(n, columns);
    }
  });
}

}  // namespace ricochet::modes
