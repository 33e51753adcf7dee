#include "kernels/band.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

namespace ricochet::kernels {
namespace {

using Complex = std::complex<double>;

/// s² along the ray s = ω e^{iπ/4}, evenly in ω up to the band's end.
std::vector<Complex> samples(RadPerSecond band) {
  constexpr int count = 24;
  std::vector<Complex> squares;
  for (int k = 1; k <= count; ++k) squares.emplace_back(0, std::pow(band.value * k / count, 2));
  return squares;
}

/// Gram matrix of the traces: entry (i, j) is B_iᵀ B_j.
std::vector<double> gram(const BandModes& a, const BandModes& b) {
  const std::size_t n = a.lambda.size(), m = b.lambda.size();
  const std::size_t c = n > 0 ? a.trace.size() / n : 0;
  std::vector<double> products(n * m);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < m; ++j)
      products[i * m + j] = std::inner_product(a.trace.begin() + static_cast<std::ptrdiff_t>(i * c),
                                               a.trace.begin() + static_cast<std::ptrdiff_t>((i + 1) * c),
                                               b.trace.begin() + static_cast<std::ptrdiff_t>(j * c), 0.0);
  return products;
}

/// Re trace(Hᵃ* Hᵇ) of Hᵃ = Σ x_n B_n B_nᵀ, Hᵇ likewise: with the Gram matrix of the traces no matrix of the
/// surface's size is made.
double product(const std::vector<Complex>& x, const std::vector<Complex>& y,
               const std::vector<double>& grams) {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t j = 0; j < y.size(); ++j) {
      const double g = grams[i * y.size() + j];
      sum += (std::conj(x[i]) * y[j]).real() * g * g;
    }
  return sum;
}

std::vector<Complex> weights(const BandModes& modes, Complex square, bool less_static) {
  std::vector<Complex> x;
  for (const double lambda : modes.lambda)
    x.push_back(1.0 / (lambda + square) - (less_static ? 1.0 / lambda : 0.0));
  return x;
}

}  // namespace

double flexibility_error(const BandModes& coarse, const BandModes& fine, RadPerSecond band,
                         bool quasi_static) {
  const auto cc = gram(coarse, coarse), cf = gram(coarse, fine), ff = gram(fine, fine);
  double worst = 0;
  for (const Complex square : samples(band)) {
    const auto whole = weights(fine, square, false);
    const auto x = weights(coarse, square, quasi_static), y = weights(fine, square, quasi_static);
    const double norm = product(whole, whole, ff);
    const double difference = product(x, x, cc) - 2 * product(x, y, cf) + product(y, y, ff);
    if (norm > 0) worst = std::max(worst, std::sqrt(std::max(difference, 0.0) / norm));
  }
  return worst;
}

Contributions::Contributions(const BandModes& modes, RadPerSecond band)
    : count_(modes.lambda.size()), gram_(gram(modes, modes)), ascending_(count_) {
  std::vector<double> share(count_, 0.0);
  for (const Complex square : samples(band)) {
    const auto whole = weights(modes, square, false);
    moving_.push_back(weights(modes, square, true));
    norm_.push_back(std::sqrt(product(whole, whole, gram_)));
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
    if (norm_[sample] > 0)
      worst = std::max(worst, std::sqrt(std::max(product(x, x, gram_), 0.0)) / norm_[sample]);
  }
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

namespace {

/// Columns of a (rows, keep.size()) matrix that are kept.
template <class T>
void keep_columns(std::vector<T>& matrix, const std::vector<bool>& keep) {
  std::size_t to = 0;
  for (std::size_t from = 0; from < matrix.size(); ++from)
    if (keep[from % keep.size()]) matrix[to++] = matrix[from];
  matrix.resize(to);
}

/// Takes modes out of a kernel and adds what they give statically to its residual flexibility.
void leave_out(Kernel& kernel, const std::vector<bool>& keep) {
  const std::size_t n = keep.size(), rows = kernel.surface.shape.size() / n;
  for (std::size_t k = 0; k < n; ++k) {
    if (keep[k]) continue;
    const double lambda = std::pow(kernel.modes.angular_frequency[k], 2);
    const auto trace = [&](std::size_t i) { return kernel.surface.shape[i * n + k]; };
    for (std::size_t i = 0; i < rows; ++i) {
      for (std::size_t j = 0; j < rows; ++j)
        kernel.surface.residual_flexibility[i * rows + j] += trace(i) * trace(j) / lambda;
      for (std::size_t d = 0; d < 3; ++d)
        kernel.loads.body_force_residual[i * 3 + d] += trace(i) * kernel.loads.body_force[d * n + k] / lambda;
    }
  }
  for (std::vector<double>* matrix :
       {&kernel.modes.angular_frequency, &kernel.modes.decay_rate, &kernel.modes.residual,
        &kernel.surface.shape, &kernel.loads.body_force, &kernel.loads.rotation})
    keep_columns(*matrix, keep);
  if (kernel.view) keep_columns(kernel.view->shape, keep);
}

}  // namespace

double keep_contributing(Kernel& kernel, RadPerSecond band, double error) {
  const std::size_t n = kernel.modes.size();
  const auto& omega = kernel.modes.angular_frequency;
  const auto rigid = static_cast<std::size_t>(std::ranges::count(omega, 0.0));
  if (rigid == n) return 0;
  const std::size_t elastic = n - rigid, rows = kernel.surface.shape.size() / n;
  std::vector<double> lambda(elastic), trace(elastic * rows);
  for (std::size_t k = 0; k < elastic; ++k) {
    lambda[k] = omega[rigid + k] * omega[rigid + k];
    for (std::size_t i = 0; i < rows; ++i) trace[k * rows + i] = kernel.surface.shape[i * n + rigid + k];
  }
  const Contributions worth({lambda, trace}, band);
  std::vector<bool> keep(n, true), without(elastic, false);
  const std::size_t dispensable = worth.dispensable(worth.ascending(), error);
  for (std::size_t k = 0; k < dispensable; ++k) {
    keep[rigid + worth.ascending()[k]] = false;
    without[worth.ascending()[k]] = true;
  }
  leave_out(kernel, keep);
  return worth.error_without(without);
}

}  // namespace ricochet::kernels
