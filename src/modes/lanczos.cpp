// SPDX-License-Identifier: BSD-2-Clause
#include "src/modes/lanczos.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "kernels/algebra.hpp"
#include "src/modes/symmetric.hpp"
#include "src/modes/tall.hpp"

namespace ricochet::modes {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Norm below which a column of a block counts as linearly dependent, relative to the largest.
constexpr double rank_tolerance = 1e-12;

/// Largest number of columns of a block.
constexpr Index widest_block = 256;

/// Q and the block tridiagonal T of one iteration.
class Basis {
 public:
  Basis(const Operators& operators, Factorisation& factor, const LanczosOptions& options)
      : operators_(operators), factor_(factor) {
    const Index most = std::min<Index>(options.basis, operators.free_rows) + options.block;
    q_.resize(operators.local_rows, most);
    t_ = MatrixXd::Zero(most, most);
    MatrixXd start = factor_.solve(operators_.mass(operators_.noise(options.block, options.seed)));
    append(start);
  }

  /// Number of vectors whose image lies in the span of all vectors; the last block is excluded.
  Index inner_size() const { return inner_; }
  Index size() const { return size_; }
  bool exhausted() const { return inner_ == size_; }
  const MatrixXd& vectors() const { return q_; }
  auto projected() const { return t_.topLeftCorner(inner_, inner_); }
  /// B: coupling of the last inner block with the next one, (columns of the next, columns of the last).
  auto coupling() const { return t_.block(inner_, last_, size_ - inner_, inner_ - last_); }
  /// (MQ⁺)ᵀ(MQ⁺) of the next block, for residuals in the 2-norm.
  const MatrixXd& next_momentum() const { return next_momentum_; }
  /// Smallest 2-norm of M times a basis vector; scale of the residuals.
  double momentum() const { return typical_momentum_; }

  void step() {
    MatrixXd next = factor_.solve(momentum_.rightCols(size_ - inner_));
    previous_ = last_;
    last_ = inner_;
    inner_ = size_;
    append(next);
  }

 private:
  /// Orthogonalises `next` against all vectors, fills the columns of T and appends the remainder to the
  /// basis.
  void append(MatrixXd& next) {
    const Index width = next.cols();
    tall_subtract(operators_.rigid, inner(operators_.comm, operators_.rigid_momentum, next), next);
    MatrixXd momentum = operators_.mass(next);
    const double scale = inner(operators_.comm, next, momentum).diagonal().cwiseAbs().maxCoeff();
    if (inner_ > 0) {
      // The components along the two blocks of the recurrence form T.
      const auto near = q_.middleCols(previous_, size_ - previous_);
      const MatrixXd share = inner(operators_.comm, near, momentum);
      tall_subtract(near, share, next);
      tall_subtract(momentum_, share, momentum);
      t_.block(last_, last_, width, width) = share.bottomRows(width);
      if (previous_ > 0) {
        // Components along the other blocks are only round-off, but the iteration would amplify them. Single
        // precision does not suffice here: its noise would limit residuals to 1e-6.
        const auto far = q_.leftCols(previous_);
        tall_subtract(far, inner(operators_.comm, far, momentum), next);
      }
      momentum = operators_.mass(next);
      if (inner(operators_.comm, next, momentum).diagonal().minCoeff() < 1e-6 * scale) again(next, momentum);
    }
    // M-orthonormalises the columns by the eigenvectors of the Gram matrix, twice for full accuracy. A column
    // that depends on others, or on the basis, is noise after the first pass and is dropped in the second.
    MatrixXd coupling = MatrixXd::Identity(width, width);
    for (int pass = 0; pass < 2 && next.cols() > 0; ++pass) {
      MatrixXd gram = inner(operators_.comm, next, momentum);
      gram = (gram + gram.transpose().eval()) / 2;
      const VectorXd square = eigen_decomposition(operators_.comm, gram);
      const double bound = pass == 0 ? rank_tolerance * rank_tolerance * scale : 0.5;
      Index dropped = 0;
      while (dropped < gram.rows() && square[dropped] <= bound) ++dropped;
      const Index kept = gram.rows() - dropped;
      const VectorXd size = square.tail(kept).cwiseSqrt();
      const MatrixXd turn = gram.rightCols(kept);
      coupling = (size.asDiagonal() * turn.transpose() * coupling).eval();
      const MatrixXd normal = turn * size.cwiseInverse().asDiagonal();
      next = (next * normal).eval();
      momentum = (momentum * normal).eval();
      if (pass == 0 && kept > 0 && size[0] < 1e-5 * std::sqrt(scale)) again(next, momentum);
    }
    const Index kept = next.cols(), near = size_ - last_;
    q_.middleCols(size_, kept) = next;
    if (inner_ > 0) t_.block(size_, last_, kept, width) = coupling;
    // M times the last two blocks, which the next step needs.
    MatrixXd both(next.rows(), (inner_ > 0 ? near : 0) + kept);
    if (inner_ > 0) both.leftCols(near) = momentum_.rightCols(near);
    both.rightCols(kept) = momentum;
    momentum_ = std::move(both);
    size_ += kept;
    next_momentum_ = inner(operators_.comm, momentum, momentum);
    for (Index j = 0; j < kept; ++j) {
      const double norm = std::sqrt(next_momentum_(j, j));
      typical_momentum_ = typical_momentum_ > 0 ? std::min(typical_momentum_, norm) : norm;
    }
  }

  /// Orthogonalises once more against all vectors; needed if little of the columns remains.
  void again(MatrixXd& next, MatrixXd& momentum) const {
    const auto q = q_.leftCols(size_);
    tall_subtract(q, inner(operators_.comm, q, momentum), next);
    momentum = operators_.mass(next);
  }

  const Operators& operators_;
  Factorisation& factor_;
  MatrixXd q_, t_;
  MatrixXd momentum_;  ///< M times the last two blocks
  MatrixXd next_momentum_;
  Index inner_ = 0, size_ = 0, last_ = 0, previous_ = 0;
  double typical_momentum_ = 0;
};

/// The current state of the projected problem.
struct Ritz {
  VectorXd theta, lambda, residual;  ///< sorted by λ; residual relative to ‖Kx‖
  MatrixXd vector, next;             ///< s, and B s / θ: parts in the inner blocks and in the next one
};

Ritz ritz_of(MPI_Comm comm, const Basis& basis, double sigma) {
  const Index m = basis.inner_size();
  MatrixXd vectors = basis.projected();
  const VectorXd theta = eigen_decomposition(comm, vectors);
  std::vector<Index> order(static_cast<std::size_t>(m));
  std::iota(order.begin(), order.end(), 0);
  const auto lambda = [&](Index i) { return sigma + 1 / theta[i]; };
  std::sort(order.begin(), order.end(), [&](Index a, Index b) { return lambda(a) < lambda(b); });
  Ritz ritz;
  ritz.theta = theta(order);
  ritz.lambda = (sigma + ritz.theta.array().inverse()).matrix();
  ritz.vector = vectors(Eigen::all, order);
  ritz.next = basis.coupling() * ritz.vector.bottomRows(basis.coupling().cols()) *
              ritz.theta.cwiseInverse().asDiagonal();
  ritz.residual = (ritz.next.cwiseProduct(basis.next_momentum() * ritz.next).colwise().sum().cwiseAbs())
                      .cwiseSqrt()
                      .transpose();
  ritz.residual.array() /= ritz.theta.array().abs() * ritz.lambda.array().abs() * basis.momentum();
  return ritz;
}

/// Largest residual of the Ritz values in an interval.
double worst_inside(const Ritz& ritz, const Interval& interval) {
  double worst = 0;
  for (Index i = 0; i < ritz.lambda.size(); ++i)
    if (ritz.lambda[i] >= interval.from && ritz.lambda[i] <= interval.to)
      worst = std::max(worst, ritz.residual[i]);
  return worst;
}

/// The converged Ritz values about the shift, without a gap: the range [first, end), and the interval that
/// it covers.
struct ConvergedRange {
  Index first = 0, end = 0;
  Interval covered;
  bool complete = false;
  Interval sought;  ///< from the lowest to the highest Ritz value of those that are sought
};

/// Eigenvalues closer than this share of their mean distance belong together: no slice ends between them.
constexpr double close_together = 0.5;

/// Largest number of eigenvalues by which an interval is extended to end in a gap.
constexpr Index most_beyond = 64;

ConvergedRange converged_of(const Ritz& ritz, double sigma, const Interval& wanted, Index modes_below,
                            const LanczosOptions& options, bool exhausted) {
  // The bound leaves a margin, because residuals are only estimated here. They are verified at the end.
  const double bound = 0.7 * options.tolerance;
  // The next Ritz value outside must have appeared, to this accuracy; otherwise, one inside might still be
  // missing.
  const double shown = 1e-2;
  const auto appeared = [&](Index i) {
    return i >= 0 && i < ritz.lambda.size() &&
           ritz.residual[i] * std::abs(ritz.lambda[i] / (ritz.lambda[i] - sigma)) <= shown;
  };
  const Index m = ritz.lambda.size();
  const auto place = [&](double lambda) {
    return static_cast<Index>(std::lower_bound(ritz.lambda.begin(), ritz.lambda.end(), lambda) -
                              ritz.lambda.begin());
  };
  const Index start = place(sigma), lowest = place(wanted.from), beyond = place(wanted.to);
  const double gap =
      close_together * (wanted.to - wanted.from) / static_cast<double>(std::max<Index>(1, beyond - lowest));
  const auto distance = [&](Index i) { return ritz.lambda[i] - ritz.lambda[i - 1]; };
  // A multiple eigenvalue at the end of the number sought belongs to it as a whole, and one more shows where
  // it ends.
  Index counted = std::min(m, start + static_cast<Index>(options.above.value_or(0)));
  while (counted > 0 && counted < m &&
         ritz.lambda[counted] < (1 + kernels::multiple_mode) * ritz.lambda[counted - 1])
    ++counted;
  const Index end = std::clamp<Index>(options.above ? counted + 1 : beyond, start, m),
              first = std::min(lowest, start);
  Index to = end, from = first;
  while (to > start && to < m && to < end + most_beyond && distance(to) < gap) ++to;
  while (from > 0 && from < start && from > first - most_beyond && distance(from) < gap) --from;
  ConvergedRange range{start, start, {sigma, sigma}, false, {sigma, sigma}};
  if (to > start) range.sought.to = ritz.lambda[to - 1];
  if (from < start) range.sought.from = ritz.lambda[from];
  while (range.end < to && ritz.residual[range.end] <= bound) ++range.end;
  while (range.first > from && ritz.residual[range.first - 1] <= bound) --range.first;
  const bool right = exhausted || (range.end == to && appeared(to));
  // If the interval extends to zero, the inertia gives the number of modes.
  const bool left = wanted.from <= 0 ? start - range.first == modes_below
                                     : exhausted || (range.first == from && appeared(from - 1));
  if (range.end > start) range.covered.to = ritz.lambda[range.end - 1];
  if (range.first < start) range.covered.from = ritz.lambda[range.first];
  // A complete interval ends within the gap, or where it was wanted to if that is farther.
  if (right) {
    if (range.end > start && range.end < m) range.covered.to += distance(range.end) / 4;
    if (!options.above || exhausted) range.covered.to = std::max(range.covered.to, wanted.to);
  }
  if (left) {
    if (range.first < start && range.first > 0) range.covered.from -= distance(range.first) / 4;
    range.covered.from = std::min(range.covered.from, wanted.from);
  }
  range.complete = left && right;
  return range;
}

}  // namespace

LanczosOptions other_start(const LanczosOptions& options) {
  LanczosOptions other = options;
  other.seed += static_cast<std::uint64_t>(options.block);
  other.block = std::min<Index>(2 * options.block, widest_block);
  return other;
}

Converged lanczos(const Operators& operators, Factorisation& factor, const Interval& wanted,
                  const LanczosOptions& options, const parallel::Progress& progress) {
  const double sigma = factor.sigma();
  Basis basis(operators, factor, options);
  Ritz ritz;
  ConvergedRange range;
  // Solving the projected problem costs as much as a step. It is skipped until the residuals can be small
  // enough, judging by the rate between the last two solutions.
  Index next_look = 6 * options.block, looked = 0;
  double worst = 1;
  for (;;) {
    basis.step();
    const bool last = basis.exhausted() || basis.size() + options.block > basis.vectors().cols();
    if (!last && basis.inner_size() < next_look) continue;
    ritz = ritz_of(operators.comm, basis, sigma);
    range =
        converged_of(ritz, sigma, wanted, factor.below() - operators.below_zero, options, basis.exhausted());
    if (progress) progress(range.end - range.first, 0);
    if (range.complete || last) break;
    const double before = std::exchange(worst, worst_inside(ritz, range.sought));
    const Index m = basis.inner_size();
    double wait = 0.15 * static_cast<double>(m);
    if (looked > 0 && worst < 1e-2 && worst < before)
      wait = std::min(wait, 0.9 * static_cast<double>(m - looked) * std::log(worst / options.tolerance) /
                                std::log(before / worst));
    looked = m;
    next_look = m + std::max<Index>(1, static_cast<Index>(wait));
  }
  Converged found;
  found.covered = range.covered;
  const Index n = range.end - range.first;
  found.lambda = ritz.lambda.segment(range.first, n);
  const Index m = basis.inner_size(), outer = basis.size() - m;
  const MatrixXd s = ritz.vector.middleCols(range.first, n), b = ritz.next.middleCols(range.first, n);
  found.shape.noalias() = basis.vectors().leftCols(m) * s;
  found.shape.noalias() += basis.vectors().middleCols(m, outer) * b;
  found.shape *= (1 + b.colwise().squaredNorm().array()).rsqrt().matrix().asDiagonal();
  return found;
}

}  // namespace ricochet::modes
