// SPDX-License-Identifier: BSD-2-Clause
#include "kernels/band.hpp"

#include "kernels/compression.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <random>
#include <utility>

namespace ricochet::kernels {
namespace {

using Complex = std::complex<double>;
using Matrix = Eigen::MatrixXd;
using ComplexMatrix = Eigen::MatrixXcd;

/// Matrix (c,N) of the traces.
Matrix traces(const BandModes& modes) {
  const auto n = static_cast<Eigen::Index>(modes.lambda.size());
  if (n == 0) return {};
  return Eigen::Map<const Matrix>(modes.trace.data(), modes.trace.size() / n, n);
}

/// The factor by which a matrix of c columns is multiplied to estimate its Frobenius norm: the identity, or,
/// for a large matrix, 64 vectors of random signs (Hutchinson).
Matrix directions(Eigen::Index c) {
  constexpr Eigen::Index most = 64;
  if (c <= most) return Matrix::Identity(c, c);
  std::minstd_rand random;
  return Matrix::NullaryExpr(c, most,
                             [&](Eigen::Index, Eigen::Index) { return random() % 2 == 0 ? 0.125 : -0.125; });
}

/// s² along the ray s = ω e^{iπ/4}, with ω evenly spaced up to the end of the band.
std::vector<Complex> samples(RadPerSecond band) {
  constexpr int count = 24;
  std::vector<Complex> squares;
  for (int k = 1; k <= count; ++k) squares.emplace_back(0, std::pow(band.value * k / count, 2));
  return squares;
}

/// Gram matrix of the traces: entry (i, j) is B_iᵀ B_j.
std::vector<double> gram(const BandModes& modes) {
  const Matrix b = traces(modes), products = b.transpose() * b;
  return {products.data(), products.data() + products.size()};
}

/// Frobenius norm of Σ x_n B_n B_nᵀ. With the Gram matrix of the traces, no matrix of the size of the surface
/// is formed.
double norm_of(const std::vector<Complex>& x, const std::vector<double>& grams) {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t j = 0; j < x.size(); ++j) {
      const double g = grams[i * x.size() + j];
      sum += (std::conj(x[i]) * x[j]).real() * g * g;
    }
  return std::sqrt(std::max(sum, 0.0));
}

std::vector<Complex> weights(const BandModes& modes, Complex square, bool less_static) {
  std::vector<Complex> x;
  for (const double lambda : modes.lambda)
    x.push_back(1.0 / (lambda + square) - (less_static ? 1.0 / lambda : 0.0));
  return x;
}

/// Keeps the selected columns of a (rows, keep.size()) matrix.
template <class T>
void keep_columns(std::vector<T>& matrix, const std::vector<bool>& keep) {
  std::size_t to = 0;
  for (std::size_t from = 0; from < matrix.size(); ++from)
    if (keep[from % keep.size()]) matrix[to++] = matrix[from];
  matrix.resize(to);
}

/// Keeps the selected rows and columns of a square matrix.
template <class T>
void keep_square(std::vector<T>& matrix, const std::vector<bool>& keep) {
  std::size_t to = 0;
  for (std::size_t from = 0; from < matrix.size(); ++from)
    if (keep[from / keep.size()] && keep[from % keep.size()]) matrix[to++] = matrix[from];
  matrix.resize(to);
}

/// Keeps the pairs of kept modes, renumbered.
void keep_pairs(Coriolis& coriolis, const std::vector<bool>& keep) {
  std::vector<std::int64_t> number(keep.size());
  std::exclusive_scan(keep.begin(), keep.end(), number.begin(), std::int64_t{0});
  Coriolis kept;
  for (std::size_t k = 0; 2 * k < coriolis.pair.size(); ++k) {
    const auto m = static_cast<std::size_t>(coriolis.pair[2 * k]),
               n = static_cast<std::size_t>(coriolis.pair[2 * k + 1]);
    if (!keep[m] || !keep[n]) continue;
    kept.pair.insert(kept.pair.end(), {number[m], number[n]});
    const auto g = coriolis.coupling.begin() + static_cast<std::ptrdiff_t>(3 * k);
    kept.coupling.insert(kept.coupling.end(), g, g + 3);
  }
  coriolis = std::move(kept);
}

/// Adds left_k right_kᵀ / λ to block `at` of a matrix (rows, blocks · width), where left_k and right_k are
/// column k of left (rows, n) and right (width, n). An empty matrix stays empty.
template <class T>
void add_product(std::vector<T>& matrix, const std::vector<T>& left, const std::vector<double>& right,
                 std::size_t k, std::size_t n, double lambda, std::size_t at = 0, std::size_t blocks = 1) {
  const std::size_t width = right.size() / n;
  for (std::size_t i = 0; i < matrix.size() / (width * blocks); ++i)
    for (std::size_t j = 0; j < width; ++j)
      matrix[(i * blocks + at) * width + j] += static_cast<T>(left[i * n + k] * right[j * n + k] / lambda);
}

/// Adds the static part of mode k to the static corrections of an output: a receiver, a gauge or the
/// visualisation surface.
void leave_seen(auto& seen, const Kernel& kernel, const std::vector<double>& trace, std::size_t k,
                double lambda) {
  const std::size_t n = kernel.modes.size(), loads = kernel.applied.size(), motions = kernel.motions.size();
  add_product(seen.residual_flexibility, seen.shape, trace, k, n, lambda);
  add_product(seen.body_force_residual, seen.shape, kernel.loads.body_force, k, n, lambda);
  for (std::size_t l = 0; l < loads; ++l)
    add_product(seen.load_residual, seen.shape, kernel.applied[l].participation, k, n, lambda, l, loads);
  for (std::size_t s = 0; s < motions; ++s)
    add_product(seen.motion_residual, seen.shape, kernel.motions[s].participation, k, n, 1, s, motions);
}

/// Adds the static part of mode k to the static corrections of loads, moving supports, receivers, gauges and
/// the visualisation surface. A support also takes over its share of the mode: Ψ − ΦΓ grows by φ_k Γ_k.
void leave_sources(Kernel& kernel, const std::vector<double>& trace, std::size_t k, double lambda) {
  const std::size_t n = kernel.modes.size();
  const std::vector<double>&shape = kernel.surface.shape, &gravity = kernel.loads.body_force;
  for (Load& load : kernel.applied) add_product(load.residual, trace, load.participation, k, n, lambda);
  for (Motion& motion : kernel.motions) {
    add_product(motion.residual, shape, motion.participation, k, n, 1);
    add_product(motion.momentum, gravity, motion.participation, k, n, 1);
  }
  for (Receiver& receiver : kernel.receivers) leave_seen(receiver, kernel, trace, k, lambda);
  for_each_sensitivity(kernel, [&](auto& seen) { leave_seen(seen, kernel, trace, k, lambda); });
  if (kernel.view) leave_seen(*kernel.view, kernel, trace, k, lambda);
}

/// The elastic modes of a kernel; rigid modes come first.
struct Elastic {
  std::size_t rigid;
  std::vector<double> lambda, trace;
  BandModes modes() const { return {lambda, trace}; }
};

Elastic elastic_of(const Kernel& kernel) {
  const std::size_t n = kernel.modes.size();
  const std::vector<double>& omega = kernel.modes.angular_frequency;
  Elastic elastic{static_cast<std::size_t>(std::ranges::count(omega, 0.0)), {}, {}};
  if (elastic.rigid == n) return elastic;
  const std::vector<double> trace = residual_trace(kernel);
  const std::size_t rows = trace.size() / n;
  for (std::size_t k = elastic.rigid; k < n; ++k) {
    elastic.lambda.push_back(omega[k] * omega[k]);
    for (std::size_t i = 0; i < rows; ++i) elastic.trace.push_back(trace[i * n + k]);
  }
  return elastic;
}

}  // namespace

double flexibility_error(const BandModes& coarse, const BandModes& fine, RadPerSecond band,
                         bool quasi_static) {
  if (fine.lambda.empty()) return 0;  // whose flexibility is zero
  // Gram matrices are not used here: their rounding would hide errors below 1e-8 (band/lowest mode)².
  const Matrix f = traces(fine);
  const Matrix b = coarse.lambda.empty() ? Matrix(f.rows(), 0) : traces(coarse);
  const Matrix sketch = directions(f.rows());
  const Matrix coarse_right = b.transpose() * sketch, fine_right = f.transpose() * sketch;
  const auto flexibility = [](const Matrix& left, const std::vector<Complex>& x, const Matrix& right) {
    return ComplexMatrix(left *
                         (Eigen::Map<const Eigen::VectorXcd>(x.data(), left.cols()).asDiagonal() * right));
  };
  double worst = 0;
  for (const Complex square : samples(band)) {
    const double norm = flexibility(f, weights(fine, square, false), fine_right).norm();
    const double difference = (flexibility(b, weights(coarse, square, quasi_static), coarse_right) -
                               flexibility(f, weights(fine, square, quasi_static), fine_right))
                                  .norm();
    if (norm > 0) worst = std::max(worst, difference / norm);
  }
  return worst;
}

std::size_t resolved_modes(const Kernel& kernel) {
  const auto resolved = static_cast<std::size_t>(resolved_part * static_cast<double>(kernel.dofs));
  return kernel.dofs > 0 ? std::min(kernel.modes.size(), resolved) : kernel.modes.size();
}

Contributions::Contributions(const BandModes& modes, RadPerSecond band)
    : count_(modes.lambda.size()), band_(band), gram_(gram(modes)), ascending_(count_) {
  std::vector<double> share(count_, 0.0);
  for (const Complex square : samples(band)) {
    const auto whole = weights(modes, square, false);
    moving_.push_back(weights(modes, square, true));
    norm_.push_back(norm_of(whole, gram_));
    for (std::size_t i = 0; i < count_ && norm_.back() > 0; ++i)
      share[i] = std::max(share[i], gram_[i * count_ + i] * std::abs(moving_.back()[i]) / norm_.back());
  }
  std::iota(ascending_.begin(), ascending_.end(), std::size_t{0});
  std::ranges::stable_sort(ascending_, {}, [&](std::size_t k) { return share[k]; });
}

double Contributions::error_without(const std::vector<bool>& left_out) const {
  double worst = 0;
  for (std::size_t sample = 0; sample < norm_.size(); ++sample) {
    std::vector<Complex> x = moving_[sample];
    for (std::size_t k = 0; k < count_; ++k)
      if (!left_out[k]) x[k] = 0;
    if (norm_[sample] > 0) worst = std::max(worst, norm_of(x, gram_) / norm_[sample]);
  }
  return worst;
}

double Contributions::error_above(RadPerSecond end, double flexibility) const {
  const double lambda = end.value * end.value;
  const std::vector<Complex> squares = samples(band_);
  double worst = 0;
  for (std::size_t k = 0; k < squares.size(); ++k)
    worst = std::max(worst, std::abs(squares[k] / (lambda + squares[k])) * flexibility / norm_[k]);
  return worst;
}

std::size_t Contributions::dispensable(const std::vector<std::size_t>& order, double error) const {
  std::size_t fine = 0, too_many = order.size() + 1;
  while (too_many - fine > 1) {
    const std::size_t middle = fine + (too_many - fine) / 2;
    std::vector<bool> left_out(count_, false);
    for (std::size_t k = 0; k < middle; ++k) left_out[order[k]] = true;
    (error_without(left_out) <= error ? fine : too_many) = middle;
  }
  return fine;
}

std::vector<double> residual_trace(const Kernel& kernel) {
  const Surface& surface = kernel.surface;
  if (!surface.normal_residual) return surface.shape;
  const std::size_t n = kernel.modes.size();
  std::vector<double> trace(surface.size() * n, 0.0);
  for (std::size_t row = 0; row < 3 * surface.size(); ++row)
    for (std::size_t k = 0; k < n; ++k)
      trace[row / 3 * n + k] += surface.normal[row] * surface.shape[row * n + k];
  return trace;
}

void truncate(Kernel& kernel, const std::vector<bool>& keep) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using Eigen::Index;
  std::vector<Index> leaving;
  Eigen::VectorXd inverse(keep.size());
  const std::vector<double> shape = residual_trace(kernel);
  for (std::size_t k = 0; k < keep.size(); ++k) {
    if (keep[k]) continue;
    leaving.push_back(k);
    leave_sources(kernel, shape, k, std::pow(kernel.modes.angular_frequency[k], 2));
    inverse[k] = std::pow(kernel.modes.angular_frequency[k], -2);
  }
  if (leaving.empty()) return;
  const auto n = static_cast<Index>(keep.size()), rows = static_cast<Index>(shape.size()) / n;
  const Matrix trace = Eigen::Map<const RowMajor>(shape.data(), rows, n)(Eigen::all, leaving);
  const Matrix flexible = trace * inverse(leaving).asDiagonal();
  if (kernel.surface.compact)
    add_square(*kernel.surface.compact, trace * inverse(leaving).cwiseSqrt().asDiagonal());
  if (!kernel.surface.residual_flexibility.empty()) {
    Eigen::Map<RowMajor> r(kernel.surface.residual_flexibility.data(), rows, rows);
    r.triangularView<Eigen::Lower>() += flexible * trace.transpose();
    r.triangularView<Eigen::StrictlyUpper>() = r.transpose();
  }
  if (!kernel.loads.body_force_residual.empty())
    Eigen::Map<RowMajor>(kernel.loads.body_force_residual.data(), rows, 3) +=
        flexible *
        Eigen::Map<const RowMajor>(kernel.loads.body_force.data(), 3, n)(Eigen::all, leaving).transpose();
  for (std::vector<double>* values :
       {&kernel.modes.angular_frequency, &kernel.modes.decay_rate, &kernel.modes.residual})
    keep_columns(*values, keep);
  keep_square(kernel.modes.stiffness_error, keep);
  keep_pairs(kernel.modes.coriolis, keep);
  for_each_of_modes(kernel, [&](auto& values) { keep_columns(values, keep); });
}

Kernel truncated_above(Kernel kernel, RadPerSecond end) {
  std::vector<bool> keep;
  for (const double omega : kernel.modes.angular_frequency) keep.push_back(omega <= end.value);
  truncate(kernel, keep);
  return kernel;
}

double truncation_error(const Kernel& kernel, RadPerSecond end, RadPerSecond band) {
  const Elastic elastic = elastic_of(kernel);
  std::vector<bool> without;
  for (const double lambda : elastic.lambda) without.push_back(lambda > end.value * end.value);
  if (without.empty()) return 0;
  return Contributions(elastic.modes(), band).error_without(without);
}

double error_above(const Kernel& kernel, RadPerSecond band, RadPerSecond end) {
  return Contributions(elastic_of(kernel).modes(), band).error_above(end, norm_bound(kernel.surface));
}

double truncate_least_contributing(Kernel& kernel, RadPerSecond band, double error) {
  const Elastic elastic = elastic_of(kernel);
  const std::size_t n = kernel.modes.size(), rigid = elastic.rigid;
  if (rigid == n) return 0;
  const Contributions worth(elastic.modes(), band);
  std::vector<bool> keep(n, true), without(n - rigid, false);
  const std::size_t dispensable = worth.dispensable(worth.ascending(), error);
  for (std::size_t k = 0; k < dispensable; ++k) {
    keep[rigid + worth.ascending()[k]] = false;
    without[worth.ascending()[k]] = true;
  }
  truncate(kernel, keep);
  return worth.error_without(without);
}

}  // namespace ricochet::kernels
