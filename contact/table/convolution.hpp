// SPDX-License-Identifier: BSD-2-Clause
// Convolution of a sampled matrix kernel with a history that grows by a sample at a time.
//
//   y_k = Σ_{l ≥ 1} H_l x_{k−l}          H_l (rows, columns), l = 0 … L−1; x_j (columns), j = 0, 1, …
//
// Lag 0 is the caller's: contact forces are the solution of a problem that holds H_0.
//
// direct: the sum as it stands; the k-th sample costs min(k, L) products of a matrix and a vector.
// partitioned: lags below a block of B samples directly, so that nothing is late; the rest in partitions of B
// lags by FFTs of 2B samples (overlap-save, the spectra of past blocks kept), once a block, when it is full.
// A sample costs about 2B + 4L/B products instead of L. All of the latter fall to the last sample of a block.
#pragma once

#include <Eigen/Dense>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace ricochet::contact {

/// What the kernel is beyond its last sample.
enum class Tail {
  none,    ///< zero
  linear,  ///< H_{L−1} + (l − L + 1) D, D the mean slope of the last tenth: see Convolution::departure
};

struct ConvolutionOptions {
  bool partitioned = true;
  int block = 0;  ///< B, a power of two from 2 on; 0: about √(2L)
  Tail tail = Tail::none;
};

class Convolution {
 public:
  /// @param kernel  (L, rows, columns), row-major, L ≥ 1; not needed afterwards
  /// Allocates here only. The partitioned form holds twice the kernel's memory, the direct one once.
  Convolution(std::span<const double> kernel, int rows, int columns, const ConvolutionOptions& options = {});
  Convolution(const Convolution&);
  Convolution& operator=(const Convolution&);
  ~Convolution();

  /// y_k of the next sample, k = samples().
  const Eigen::VectorXd& history() const { return history_; }

  /// Adds x_k (columns) and computes y_{k+1}.
  void push(const Eigen::VectorXd& x) noexcept;

  std::int64_t samples() const { return samples_; }
  int block() const { return block_; }  ///< B; 0: direct

  /// How far the last tenth of a kernel (at least 2 steps) departs from the straight line of a linear tail:
  /// the largest |difference| of a row over the largest |value| of that row, over all rows.
  static double departure(std::span<const double> kernel, int rows, int columns);

 private:
  class Transform;

  void spectra_of(std::span<const double> kernel);
  void finish_block() noexcept;
  Eigen::Index slot(std::int64_t sample) const { return static_cast<Eigen::Index>(sample % past_.cols()); }

  int rows_, columns_, block_ = 0;
  std::int64_t length_, samples_ = 0;
  Eigen::MatrixXd near_;      ///< (rows, columns·(lags − 1)) H_l side by side, from lag 1 on
  Eigen::MatrixXd past_;      ///< (columns, ·) ring of x
  std::vector<char> active_;  ///< ring: whether that x has any value but 0
  Eigen::VectorXd history_;

  bool tail_ = false;
  Eigen::MatrixXd last_, slope_;        ///< H_{L−1}, D
  Eigen::VectorXd sum_, weighted_sum_;  ///< Σ_{l ≥ L} x_{k−l} and Σ_{l ≥ L} (l − L + 1) x_{k−l}

  // Partitioned: B + 1 bins, real parts then imaginary parts.
  std::vector<Transform> transform_;  ///< one
  std::int64_t partitions_ = 0;       ///< from the second one on
  std::vector<double> spectra_;       ///< (partitions, columns, rows, 2, B + 1)
  std::vector<double> inputs_;        ///< (partitions, columns, 2, B + 1) ring of spectra of past blocks
  std::vector<char> input_active_;    ///< (partitions, columns)
  std::vector<double> output_;        ///< (rows, 2, B + 1)
  Eigen::MatrixXd far_;               ///< (rows, B) of the block under way
};

}  // namespace ricochet::contact
