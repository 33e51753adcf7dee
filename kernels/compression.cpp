// SPDX-License-Identifier: BSD-2-Clause
#include "kernels/compression.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "kernels/flexibility.hpp"
#include "ricochet/error.hpp"

namespace ricochet::kernels {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
template <class T>
using RowMajor = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Block = Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>;

/// Candidates whose columns are computed together, and rows whose triangular systems are solved together.
constexpr std::size_t candidates_at_once = 85;
constexpr Index rows_at_once = 512;
/// Candidates at which the error is measured.
constexpr std::size_t measured_candidates = 64;
/// Raises of the diagonal of E that are tried in turn, as shares of R_ii.
constexpr std::array raises = {0.0, 1e-3, 1e-2};

/// The next number of single precision that is not below.
float rounded_up(double value) {
  const auto single = static_cast<float>(value);
  return static_cast<double>(single) < value ? std::nextafter(single, std::numeric_limits<float>::infinity())
                                             : single;
}

/// By how much rounding changes a number, relatively.
constexpr double rounding = 0x1p-24;

/// Rounds R to single precision, with its diagonal raised so that it stays semidefinite.
/// @param R  (rows,rows) symmetric
template <class T>
std::vector<float> rounded(const std::vector<T>& R, std::size_t rows, double factor = 1) {
  std::vector<float> out(R.size());
  for (std::size_t i = 0; i < rows; ++i) {
    double sum = 0;
    for (std::size_t j = 0; j < rows; ++j) {
      // The mean is symmetric to the last bit.
      const double entry =
          factor * 0.5 * (static_cast<double>(R[i * rows + j]) + static_cast<double>(R[j * rows + i]));
      out[i * rows + j] = static_cast<float>(entry);
      sum += std::abs(entry);
    }
    out[i * rows + i] = rounded_up(factor * static_cast<double>(R[i * rows + i]) + rounding * sum);
  }
  return out;
}

Vector3d place(const Surface& surface, std::size_t i) {
  return Eigen::Map<const Vector3d>(&surface.node[3 * i]);
}

/// Chooses the candidates c: each in turn is the one farthest from those before.
struct Spread {
  std::vector<Index> chosen;
  std::vector<char> is_chosen;  ///< (M)
  double spacing = 0;           ///< distance between two of them, at least [m]
};

Spread spread(const Surface& surface, const Compression& how) {
  const std::size_t M = surface.size();
  const double mean = std::accumulate(surface.area.begin(), surface.area.end(), 0.0) / static_cast<double>(M),
               least = how.spacing * std::sqrt(mean);
  Spread out;
  out.is_chosen.assign(M, 0);
  std::vector<double> distance(M, std::numeric_limits<double>::infinity());
  std::size_t next = 0;
  do {
    out.chosen.push_back(static_cast<Index>(next));
    out.is_chosen[next] = 1;
    for (std::size_t i = 0; i < M; ++i)
      distance[i] = std::min(distance[i], (place(surface, i) - place(surface, next)).norm());
    next = static_cast<std::size_t>(std::ranges::max_element(distance) - distance.begin());
    out.spacing = std::max(distance[next], least);
  } while (distance[next] >= least && out.chosen.size() < how.most_global);
  return out;
}

std::vector<Index> columns_of(std::span<const Index> candidates) {
  std::vector<Index> out;
  for (const Index i : candidates)
    for (Index a = 0; a < 3; ++a) out.push_back(3 * i + a);
  return out;
}

/// G = R_:c C⁻ᵀ. @param columns  (3M,k) R_:c, replaced by G
void factor(const std::vector<Index>& held, Eigen::Map<RowMajor<float>> columns) {
  MatrixXd square = columns(columns_of(held), Eigen::all).cast<double>();
  square = (0.5 * (square + square.transpose())).eval();
  // As large as the rounding of the columns; more only if R itself is not semidefinite.
  double jitter = rounding * square.trace() / static_cast<double>(square.rows());
  Eigen::LLT<MatrixXd> C;
  for (double added = 0;; jitter *= 10) {
    square.diagonal().array() += jitter - added;
    added = jitter;
    C.compute(square);
    if (C.info() == Eigen::Success) break;
    if (!std::isfinite(jitter)) throw SolverError("the residual flexibility is not finite");
  }
  // G C^T = R_:c within the rounding of sums of k products, however badly conditioned C is.
  const Eigen::MatrixXf lower = C.matrixLLT().cast<float>();
  C = {};
  square.resize(0, 0);
  for (Index from = 0; from < columns.rows(); from += rows_at_once) {
    auto rows = columns.middleRows(from, std::min(rows_at_once, columns.rows() - from));
    Eigen::MatrixXf transposed = rows.transpose();
    lower.triangularView<Eigen::Lower>().solveInPlace(transposed);
    rows = transposed.transpose();
  }
}

/// Lists the pairs of candidates that are near each other and not among c.
void list_near(const Surface& surface, const Spread& held, double radius, CompactFlexibility& out) {
  const std::size_t M = surface.size();
  out.near_first.push_back(0);
  for (std::size_t i = 0; i < M; ++i) {
    for (std::size_t j = i; j < M && !held.is_chosen[i]; ++j)
      if (!held.is_chosen[j] && (place(surface, i) - place(surface, j)).norm() <= radius)
        out.near_candidate.push_back(static_cast<std::int64_t>(j));
    out.near_first.push_back(std::ssize(out.near_candidate));
  }
  out.near_block.assign(9 * out.near_candidate.size(), 0);
}

/// Calls `take(i, j, block)` for each stored block E_ij.
template <class Take>
void each_near(auto& flexibility, Take&& take) {
  for (std::size_t i = 0; i + 1 < flexibility.near_first.size(); ++i)
    for (std::int64_t k = flexibility.near_first[i]; k < flexibility.near_first[i + 1]; ++k)
      take(i, static_cast<std::size_t>(flexibility.near_candidate[static_cast<std::size_t>(k)]),
           flexibility.near_block.data() + 9 * k);
}

/// Whether the stored E is positive definite on the candidates that have blocks. They are divided into slabs
/// as wide as the radius, so that E is block tridiagonal, and its Cholesky factor is computed slab by slab.
bool is_definite(const Surface& surface, double radius, const CompactFlexibility& flexibility) {
  const std::size_t M = surface.size();
  const Eigen::Map<const Eigen::Matrix3Xd> places(surface.node.data(), 3, static_cast<Index>(M));
  const Vector3d low = places.rowwise().minCoeff(), size = places.rowwise().maxCoeff() - low;
  Index axis = 0;
  size.maxCoeff(&axis);
  const auto slab_of = [&](std::size_t i) {
    return static_cast<std::size_t>((places(axis, static_cast<Index>(i)) - low[axis]) / radius);
  };
  std::vector<std::vector<std::size_t>> rows(static_cast<std::size_t>(size[axis] / radius) + 1);
  std::vector<Index> number(M);
  for (std::size_t i = 0; i < M; ++i) {
    if (flexibility.near_first[i] == flexibility.near_first[i + 1]) continue;
    number[i] = 3 * std::ssize(rows[slab_of(i)]);
    rows[slab_of(i)].push_back(i);
  }
  MatrixXd complement, coupling;  // of the slab before with this one
  for (std::size_t s = 0; s < rows.size(); ++s) {
    const auto own = 3 * std::ssize(rows[s]),
               next = s + 1 < rows.size() ? 3 * std::ssize(rows[s + 1]) : Index{0};
    MatrixXd square = MatrixXd::Zero(own, own), to_next = MatrixXd::Zero(own, next);
    const auto take = [&](std::size_t i, std::size_t j, const float* block) {
      const Matrix3d E = Block(block).cast<double>();
      const std::size_t of_i = slab_of(i), of_j = slab_of(j);
      if (of_i == s && of_j == s) {
        square.block<3, 3>(number[i], number[j]) = E;
        square.block<3, 3>(number[j], number[i]) = E.transpose();
      } else if (of_i == s && of_j == s + 1) {
        to_next.block<3, 3>(number[i], number[j]) = E;
      } else if (of_j == s && of_i == s + 1) {
        to_next.block<3, 3>(number[j], number[i]) = E.transpose();
      }
    };
    each_near(flexibility, take);
    if (own == 0) {
      coupling.resize(0, 0);
      continue;
    }
    if (coupling.size() > 0) square.selfadjointView<Eigen::Lower>().rankUpdate(coupling.transpose(), -1);
    Eigen::LLT<Eigen::Ref<MatrixXd>> L(square);
    if (L.info() != Eigen::Success) return false;
    if (next > 0) L.matrixL().solveInPlace(to_next);
    coupling = std::move(to_next);
  }
  return true;
}

/// Raises the diagonal of E until E is definite.
void make_definite(const Surface& surface, double radius, CompactFlexibility& flexibility) {
  const Flexibility whole(surface);
  const std::vector<float> before = flexibility.near_block;
  std::vector<double> own(3 * surface.size()), sum(own.size());
  std::array<double, 9> block{};
  each_near(flexibility, [&](std::size_t i, std::size_t j, const float* E) {
    if (i == j) whole.block(i, i, block.data());
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) {
        if (i == j && a == b) own[3 * i + a] = block[4 * a];
        if (i == j && a == b) continue;
        sum[3 * i + a] += std::abs(E[3 * a + b]);
        if (i != j) sum[3 * j + b] += std::abs(E[3 * a + b]);
      }
  });
  const auto raise = [&](auto&& by) {
    each_near(flexibility, [&](std::size_t i, std::size_t j, float* E) {
      if (i != j) return;
      for (std::size_t a = 0; a < 3; ++a)
        E[4 * a] = rounded_up(
            by(3 * i + a, static_cast<double>(
                              before[static_cast<std::size_t>(&E[4 * a] - flexibility.near_block.data())])));
    });
  };
  for (const double share : raises) {
    raise([&](std::size_t row, double entry) { return entry + share * own[row]; });
    if (is_definite(surface, radius, flexibility)) return;
  }
  // A diagonal that dominates needs no proof.
  raise([&](std::size_t row, double entry) { return std::max(entry, sum[row]); });
}

}  // namespace

double compact_bytes(std::size_t candidates, const Compression& how) {
  const auto M = static_cast<double>(candidates);
  if (!is_compressed(candidates, how)) return sizeof(float) * 9 * M * M;
  // Candidates c at least a distance d apart have about 2d² of the surface each. Half of the blocks is
  // stored, each with the number of its candidate.
  const double spacing = std::max(how.spacing, std::sqrt(M / 2 / static_cast<double>(how.most_global))),
               reach = how.radius * spacing;
  return 36 * M * M / (2 * spacing * spacing) + 44 * M * 2 * reach * reach;
}

double compression_bytes(std::size_t candidates, const Compression& how) {
  const auto M = static_cast<double>(candidates);
  const double spacing = std::max(how.spacing, std::sqrt(M / 2 / static_cast<double>(how.most_global))),
               held = M / (2 * spacing * spacing), others = M - held,
               // The square of c and its factor; later, slabs of the other candidates as wide as the radius,
               // of which a compact body has about four: two squares and what couples them.
      factors = 2 * 8 * 9 * held * held, slabs = 3 * 8 * 9 * others * others / 16;
  return compact_bytes(candidates, how) + std::max(factors, slabs);
}

CompactFlexibility compressed(const Surface& surface, const FlexibilityColumns& columns,
                              const Compression& how,
                              const std::function<void(std::int64_t, std::int64_t)>& advance) {
  const std::size_t M = surface.size();
  const Spread held = spread(surface, how);
  const double radius = how.radius * held.spacing;
  std::int64_t done = 0;
  const auto each_batch = [&](const std::vector<Index>& candidates, auto&& take) {
    for (std::size_t from = 0; from < candidates.size(); from += candidates_at_once) {
      const std::span<const Index> batch =
          std::span(candidates).subspan(from, std::min(candidates_at_once, candidates.size() - from));
      take(from, batch, columns(columns_of(batch)));
      advance(done += std::ssize(batch), static_cast<std::int64_t>(M));
    }
  };

  CompactFlexibility out;
  out.columns = 3 * std::ssize(held.chosen);
  out.global.resize(3 * M * static_cast<std::size_t>(out.columns));
  Eigen::Map<RowMajor<float>> global(out.global.data(), 3 * static_cast<Index>(M), out.columns);
  each_batch(held.chosen, [&](std::size_t from, std::span<const Index>, const MatrixXd& R) {
    global.middleCols(3 * static_cast<Index>(from), R.cols()) = R.cast<float>();
  });
  factor(held.chosen, global);
  list_near(surface, held, radius, out);

  Surface compact;  // what Flexibility needs of it
  compact.area = surface.area;
  compact.node = surface.node;
  compact.compact = std::move(out);
  CompactFlexibility& made = *compact.compact;
  const Flexibility flexibility(compact);
  std::vector<Index> others;
  for (std::size_t i = 0; i < M; ++i)
    if (!held.is_chosen[i]) others.push_back(static_cast<Index>(i));
  const std::size_t stride = std::max<std::size_t>(1, others.size() / measured_candidates);
  std::vector<std::pair<std::size_t, MatrixXd>> exact;  // columns of sampled candidates
  std::array<double, 9> block{};
  each_batch(others, [&](std::size_t from, std::span<const Index> batch, const MatrixXd& R) {
    for (std::size_t s = 0; s < batch.size(); ++s) {
      const auto j = static_cast<std::size_t>(batch[s]);
      const auto column = R.middleCols(3 * static_cast<Index>(s), 3);
      if ((from + s) % stride == 0) exact.emplace_back(j, column);
      for (std::size_t i = 0; i <= j; ++i) {
        const auto first = made.near_candidate.begin() + made.near_first[i],
                   last = made.near_candidate.begin() + made.near_first[i + 1],
                   found = std::lower_bound(first, last, static_cast<std::int64_t>(j));
        if (found == last || *found != static_cast<std::int64_t>(j)) continue;
        flexibility.block(i, j, block.data());  // G_i G_jᵀ, because E_ij is still 0
        Matrix3d E = column.middleRows(3 * static_cast<Index>(i), 3);
        if (i == j) E = (0.5 * (E + E.transpose())).eval();
        E -= Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(block.data());
        Eigen::Map<Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(
            made.near_block.data() + 9 * (found - made.near_candidate.begin())) = E.cast<float>();
      }
    }
  });
  make_definite(compact, radius, made);

  for (const auto& [j, column] : exact)
    for (std::size_t i = 0; i < M; ++i) {
      flexibility.block(i, j, block.data());
      const Matrix3d wrong = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(block.data()) -
                             column.middleRows(3 * static_cast<Index>(i), 3);
      for (Index b = 0; b < 3; ++b)
        made.error = std::max(
            made.error, wrong.col(b).norm() / column.col(b).segment(3 * static_cast<Index>(j), 3).norm());
    }
  return std::move(made);
}

void make_compact(Surface& surface, const Compression& how) {
  if (surface.residual_flexibility.empty() || surface.residual_components() != 3) return;
  const auto rows = static_cast<Index>(3 * surface.size());
  const Eigen::Map<const RowMajor<double>> R(surface.residual_flexibility.data(), rows, rows);
  if (is_compressed(surface.size(), how))
    surface.compact = compressed(
        surface,
        [&](std::span<const Index> columns) -> MatrixXd {
          MatrixXd out(rows, std::ssize(columns));
          for (Index c = 0; c < out.cols(); ++c) out.col(c) = R.col(columns[static_cast<std::size_t>(c)]);
          return out;
        },
        how);
  else
    surface.compact.emplace().whole = rounded(surface.residual_flexibility, static_cast<std::size_t>(rows));
  surface.residual_flexibility = {};
}

void scale(CompactFlexibility& flexibility, double factor) {
  if (!flexibility.compressed()) {
    const auto rows =
        static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(flexibility.whole.size()))));
    flexibility.whole = rounded(flexibility.whole, rows, factor);
    return;
  }
  for (float& x : flexibility.global) x = static_cast<float>(std::sqrt(factor) * static_cast<double>(x));
  // Rounding again may cost E its definiteness, so its diagonal makes up for it.
  std::vector<double> sum(3 * (flexibility.near_first.size() - 1));
  each_near(flexibility, [&](std::size_t i, std::size_t j, const float* E) {
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) {
        const double size = factor * std::abs(static_cast<double>(E[3 * a + b]));
        sum[3 * i + a] += size;
        if (i != j) sum[3 * j + b] += size;
      }
  });
  each_near(flexibility, [&](std::size_t i, std::size_t j, float* E) {
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) {
        const double entry = factor * static_cast<double>(E[3 * a + b]);
        E[3 * a + b] =
            i == j && a == b ? rounded_up(entry + rounding * sum[3 * i + a]) : static_cast<float>(entry);
      }
  });
}

CompactFlexibility restricted(const CompactFlexibility& flexibility,
                              const std::vector<std::int64_t>& points) {
  CompactFlexibility out;
  out.columns = flexibility.columns;
  out.error = flexibility.error;
  if (!flexibility.compressed()) {
    const auto rows =
        static_cast<std::int64_t>(std::lround(std::sqrt(static_cast<double>(flexibility.whole.size()))));
    for (const std::int64_t i : points)
      for (std::int64_t a = 0; a < 3; ++a)
        for (const std::int64_t j : points)
          for (std::int64_t b = 0; b < 3; ++b)
            out.whole.push_back(flexibility.whole[static_cast<std::size_t>((3 * i + a) * rows + 3 * j + b)]);
    return out;
  }
  std::vector<std::int64_t> number(flexibility.near_first.size() - 1, -1);
  for (std::size_t p = 0; p < points.size(); ++p) {
    const auto width = 3 * flexibility.columns;
    const auto from = flexibility.global.begin() + points[p] * width;
    out.global.insert(out.global.end(), from, from + width);
    number[static_cast<std::size_t>(points[p])] = static_cast<std::int64_t>(p);
  }
  struct Kept {
    std::int64_t i, j;
    std::array<float, 9> block;
  };
  std::vector<Kept> kept;
  each_near(flexibility, [&](std::size_t i, std::size_t j, const float* E) {
    if (number[i] < 0 || number[j] < 0) return;
    Kept one{std::min(number[i], number[j]), std::max(number[i], number[j]), {}};
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b)
        one.block[3 * a + b] = number[i] <= number[j] ? E[3 * a + b] : E[3 * b + a];
    kept.push_back(one);
  });
  std::ranges::sort(kept, {}, [](const Kept& one) { return std::pair(one.i, one.j); });
  out.near_first.assign(points.size() + 1, 0);
  for (const Kept& one : kept) {
    ++out.near_first[static_cast<std::size_t>(one.i) + 1];
    out.near_candidate.push_back(one.j);
    out.near_block.insert(out.near_block.end(), one.block.begin(), one.block.end());
  }
  std::partial_sum(out.near_first.begin(), out.near_first.end(), out.near_first.begin());
  return out;
}

void add_square(CompactFlexibility& flexibility, const MatrixXd& columns) {
  const Index rows = columns.rows();
  if (!flexibility.compressed()) {
    std::vector<double> sum(flexibility.whole.begin(), flexibility.whole.end());
    Eigen::Map<RowMajor<double>>(sum.data(), rows, rows) += columns * columns.transpose();
    flexibility.whole = rounded(sum, static_cast<std::size_t>(rows));
    return;
  }
  RowMajor<float> wider(rows, flexibility.columns + columns.cols());
  wider << Eigen::Map<const RowMajor<float>>(flexibility.global.data(), rows, flexibility.columns),
      columns.cast<float>();
  flexibility.global.assign(wider.data(), wider.data() + wider.size());
  flexibility.columns = wider.cols();
}

double norm_bound(const Surface& surface) {
  const auto norm = [](const auto& values) {
    return Eigen::Map<const Eigen::VectorX<typename std::decay_t<decltype(values)>::value_type>>(
               values.data(), std::ssize(values))
        .template cast<double>()
        .norm();
  };
  if (!surface.compact) return norm(surface.residual_flexibility);
  if (!surface.compact->compressed()) return norm(surface.compact->whole);
  // The trace of a semidefinite matrix is at least its norm.
  double trace = std::pow(norm(surface.compact->global), 2);
  each_near(*surface.compact, [&](std::size_t i, std::size_t j, const float* E) {
    for (std::size_t a = 0; i == j && a < 3; ++a) trace += static_cast<double>(E[4 * a]);
  });
  return trace;
}

}  // namespace ricochet::kernels
