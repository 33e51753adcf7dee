// SPDX-License-Identifier: BSD-2-Clause
#include "contact/table/convolution.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <stdexcept>

// Requires <cmath> before it.
#include <kissfft/kissfft.hh>

namespace ricochet::contact {
namespace {

/// Number of steps at the end of a response whose slope a linear tail continues.
std::int64_t tail_steps(std::int64_t length) { return std::max<std::int64_t>(2, length / 10); }

}  // namespace

/// Transforms of real signals of 2B samples. A spectrum has B + 1 bins: real parts in its first half,
/// imaginary parts in its second half.
class Convolution::Transform {
 public:
  explicit Transform(int block)
      : block_(block),
        forward_(2 * block_, false),
        inverse_(2 * block_, true),
        in_(2 * block_),
        out_(2 * block_) {}

  std::complex<double>& signal(std::size_t k) { return in_[k]; }

  /// Transforms `signal`.
  void forward(double* spectrum) noexcept {
    forward_.transform(in_.data(), out_.data());
    for (std::size_t f = 0; f <= block_; ++f) {
      spectrum[f] = out_[f].real();
      spectrum[block_ + 1 + f] = out_[f].imag();
    }
  }

  /// Computes the second half of the signal, where overlap-save is free of wrap-around.
  template <class Row>
  void inverse(const double* spectrum, Row&& half) noexcept {
    for (std::size_t f = 0; f <= block_; ++f) {
      in_[f] = {spectrum[f], spectrum[block_ + 1 + f]};
      if (f > 0 && f < block_) in_[2 * block_ - f] = std::conj(in_[f]);
    }
    inverse_.transform(in_.data(), out_.data());
    const double scale = 1 / static_cast<double>(2 * block_);
    for (std::size_t k = 0; k < block_; ++k) half(k) = scale * out_[block_ + k].real();
  }

 private:
  std::size_t block_;
  kissfft<double> forward_, inverse_;
  std::vector<std::complex<double>> in_, out_;
};

Convolution::Convolution(const Convolution&) = default;
Convolution& Convolution::operator=(const Convolution&) = default;
Convolution::~Convolution() = default;

Convolution::Convolution(std::span<const double> response, int rows, int columns, Tail tail, int block)
    : rows_(rows),
      columns_(columns),
      length_(static_cast<std::int64_t>(response.size()) / (static_cast<std::int64_t>(rows) * columns)),
      history_(Eigen::VectorXd::Zero(rows)) {
  if (rows < 1 || columns < 1 || length_ < 1 ||
      static_cast<std::size_t>(length_ * rows * columns) != response.size())
    throw std::logic_error("convolution: the response is not of shape (L, rows, columns)");
  if (block != 0 && !std::has_single_bit(static_cast<unsigned>(block)))
    throw std::logic_error("convolution: the block must be a power of two");

  const double best = std::sqrt(2 * static_cast<double>(length_));
  block_ = block > 0 ? block : static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::max(2.0, best))));
  if (block_ == 1 || length_ <= 2 * block_) block_ = 0;  // nothing to gain
  const std::int64_t lags = block_ > 0 ? block_ : length_;
  near_.resize(rows, columns * (lags - 1));
  using Sample = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;
  const auto sample = [&](std::int64_t l) { return Sample(&response[l * rows * columns], rows, columns); };
  for (std::int64_t l = 1; l < lags; ++l) near_.middleCols((l - 1) * columns, columns) = sample(l);

  tail_ = tail == Tail::linear;
  if (tail_) {
    const std::int64_t steps = std::min(tail_steps(length_), length_ - 1);
    last_ = sample(length_ - 1);
    slope_ = Eigen::MatrixXd::Zero(rows, columns);
    if (steps > 0) slope_ = (last_ - sample(length_ - 1 - steps)) / static_cast<double>(steps);
    sum_ = weighted_sum_ = Eigen::VectorXd::Zero(columns);
  }
  const std::int64_t kept = std::max<std::int64_t>(tail_ ? length_ + 1 : lags, 2 * block_);
  past_ = Eigen::MatrixXd::Zero(columns, kept);
  active_.assign(kept, 0);
  if (block_ > 0) spectra_of(response);
}

void Convolution::spectra_of(std::span<const double> response) {
  const std::size_t B = block_, rows = rows_, columns = columns_, L = length_;
  const std::size_t width = 2 * (B + 1);
  Transform& transform = transform_.emplace_back(block_);
  partitions_ = static_cast<std::int64_t>((L - 1) / B);  // lags B … L−1
  const std::size_t count = partitions_;
  spectra_.resize(count * columns * rows * width);
  inputs_.assign(count * columns * width, 0);
  input_active_.assign(count * columns, 0);
  output_.assign(rows * width, 0);
  far_ = Eigen::MatrixXd::Zero(rows_, block_);
  double* spectrum = spectra_.data();
  for (std::size_t p = 1; p <= count; ++p)
    for (std::size_t j = 0; j < columns; ++j)
      for (std::size_t i = 0; i < rows; ++i) {
        for (std::size_t k = 0; k < 2 * B; ++k) {
          const std::size_t l = p * B + k;
          transform.signal(k) = k < B && l < L ? response[(l * rows + i) * columns + j] : 0.0;
        }
        transform.forward(spectrum);
        spectrum += width;
      }
}

void Convolution::push(const Eigen::VectorXd& x) noexcept {
  assert(x.size() == columns_);
  past_.col(slot(samples_)) = x;
  active_[slot(samples_)] = (x.array() != 0).any();
  ++samples_;
  if (block_ > 0 && samples_ % block_ == 0) finish_block();

  const std::int64_t k = samples_, lags = block_ > 0 ? block_ : length_;
  if (block_ > 0)
    history_ = far_.col(k % block_);
  else
    history_.setZero();
  for (std::int64_t l = std::min(k, lags - 1); l >= 1; --l) {
    const Eigen::Index past = slot(k - l);
    if (!active_[past]) continue;
    for (Eigen::Index j = 0; j < columns_; ++j)
      if (const double value = past_(j, past); value != 0)
        history_ += value * near_.col((l - 1) * columns_ + j);
  }
  if (tail_ && k >= length_) {
    sum_ += past_.col(slot(k - length_));
    weighted_sum_ += sum_;
    history_.noalias() += last_ * sum_;
    history_.noalias() += slope_ * weighted_sum_;
  }
}

/// Adds the far lags for block b, after block b − 1 has ended. Partition p ≥ 1 (lags pB … pB + B − 1)
/// contributes the product of its spectrum and that of the blocks b − p − 1 and b − p.
void Convolution::finish_block() noexcept {
  const std::size_t B = block_, bins = B + 1, width = 2 * bins;
  const std::size_t rows = rows_, columns = columns_;
  const std::int64_t b = samples_ / block_;

  const std::size_t newest = (b - 1) % partitions_;
  for (std::size_t j = 0; j < columns; ++j) {
    bool active = false;
    for (std::size_t k = 0; k < 2 * B; ++k) {
      const std::int64_t sample = samples_ - 2 * block_ + static_cast<std::int64_t>(k);
      const double value = sample < 0 ? 0 : past_(j, slot(sample));
      active = active || value != 0;
      transform_.front().signal(k) = value;
    }
    const std::size_t at = newest * columns + j;
    input_active_[at] = active;
    if (active) transform_.front().forward(&inputs_[at * width]);
  }

  std::fill(output_.begin(), output_.end(), 0.0);
  bool any = false;
  for (std::int64_t p = 1; p <= std::min(partitions_, b); ++p)
    for (std::size_t j = 0; j < columns; ++j) {
      const std::size_t at = ((b - p) % partitions_) * columns + j;
      if (!input_active_[at]) continue;
      any = true;
      const double *x = &inputs_[at * width], *y = x + bins;
      const double* h = &spectra_[((p - 1) * columns + j) * rows * width];
      for (double* out = output_.data(); out != output_.data() + rows * width; out += width, h += width)
        for (std::size_t f = 0; f < bins; ++f) {
          out[f] += h[f] * x[f] - h[bins + f] * y[f];
          out[bins + f] += h[f] * y[f] + h[bins + f] * x[f];
        }
    }
  if (!any) {
    far_.setZero();
    return;
  }
  for (std::size_t i = 0; i < rows; ++i) transform_.front().inverse(&output_[i * width], far_.row(i));
}

double Convolution::departure(std::span<const double> response, int rows, int columns) {
  const std::int64_t size = static_cast<std::int64_t>(rows) * columns,
                     length = static_cast<std::int64_t>(response.size()) / size;
  const std::int64_t steps = std::min(tail_steps(length), length - 1);
  double worst = 0;
  for (std::int64_t i = 0; i < rows; ++i) {
    double largest = 0, distance = 0;
    for (std::int64_t j = 0; j < columns; ++j) {
      const auto value = [&](std::int64_t l) { return response[l * size + i * columns + j]; };
      for (std::int64_t l = 0; l < length; ++l) largest = std::max(largest, std::abs(value(l)));
      const double end = value(length - 1);
      const double slope = steps > 0 ? (end - value(length - 1 - steps)) / static_cast<double>(steps) : 0;
      for (std::int64_t back = 0; back <= steps; ++back)
        distance = std::max(distance,
                            std::abs(value(length - 1 - back) - (end - slope * static_cast<double>(back))));
    }
    if (distance > 0) worst = std::max(worst, distance / largest);
  }
  return worst;
}

}  // namespace ricochet::contact
