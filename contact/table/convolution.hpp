// SPDX-License-Identifier: BSD-2-Clause
// Convolution of a sampled matrix response with a signal that grows by one sample at a time.
//
//   y_k = Σ_{l ≥ 1} H_l x_{k−l}          H_l (rows, columns), l = 0 … L−1; x_j (columns), j = 0, 1, …
//
// The caller handles lag 0, because the contact forces solve a problem that contains H_0.
//
// Direct form: evaluates the sum. Sample k costs min(k, L) matrix–vector products.
// Partitioned form: evaluates the lags below a block of B samples directly, without latency, and all other
// lags in partitions of B lags by FFTs of 2B samples (overlap-save with stored spectra), once per full block.
// A sample costs about 2B + 4L/B products instead of L; the last sample of each block includes the FFTs.
#pragma once

#include <Eigen/Dense>
#include <complex>
#include <cstdint>
#include <span>
#include <vector>

namespace ricochet::contact {

/// Continuation of the response beyond its last sample.
enum class Tail {
  none,    ///< zero
  linear,  ///< H_{L−1} + (l − L + 1) D, with D the mean slope of the last tenth (Convolution::departure)
};

class Convolution {
 public:
  /// @param response  (L, rows, columns), row-major, L ≥ 1; not needed afterwards
  /// @param block  B, a power of two; 1 for the direct form, 0 for about √(2L). Responses of up to 2B samples
  ///               use the direct form.
  /// Only the constructor allocates. The partitioned form needs twice the memory of the response, the direct
  /// form as much as the response.
  Convolution(std::span<const double> response, int rows, int columns, Tail tail, int block = 0);
  Convolution(const Convolution&);
  Convolution& operator=(const Convolution&);
  ~Convolution();

  /// y_k of the next sample, where k is the number of samples pushed.
  const Eigen::VectorXd& history() const { return history_; }

  /// Adds x_k (columns) and computes y_{k+1}.
  void push(const Eigen::VectorXd& x) noexcept;

  int block() const { return block_; }  ///< B, or 0 for the direct form

  /// Departure of the last tenth of a response (at least 2 steps) from the straight line of a linear tail:
  /// the maximum over all rows of the largest |difference| divided by the largest |value| of the row.
  static double departure(std::span<const double> response, int rows, int columns);

 private:
  class Transform;

  void spectra_of(std::span<const double> response);
  void finish_block() noexcept;
  Eigen::Index slot(std::int64_t sample) const { return static_cast<Eigen::Index>(sample % past_.cols()); }

  int rows_, columns_, block_ = 0;
  std::int64_t length_, samples_ = 0;
  Eigen::MatrixXd near_;      ///< (rows, columns·(lags − 1)) H_l side by side, from lag 1 on
  Eigen::MatrixXd past_;      ///< (columns, ·) ring of x
  std::vector<char> active_;  ///< ring: whether x has nonzero values
  Eigen::VectorXd history_;

  bool tail_ = false;
  Eigen::MatrixXd last_, slope_;        ///< H_{L−1}, D
  Eigen::VectorXd sum_, weighted_sum_;  ///< Σ_{l ≥ L} x_{k−l} and Σ_{l ≥ L} (l − L + 1) x_{k−l}

  // Partitioned form: B + 1 bins, real parts followed by imaginary parts
  std::vector<Transform> transform_;  ///< one in the partitioned form, none in the direct form
  std::int64_t partitions_ = 0;       ///< number of partitions from the second one on
  std::vector<double> spectra_;       ///< (partitions, columns, rows, 2, B + 1)
  std::vector<double> inputs_;        ///< (partitions, columns, 2, B + 1) ring of spectra of past blocks
  std::vector<char> input_active_;    ///< (partitions, columns)
  std::vector<double> output_;        ///< (rows, 2, B + 1)
  Eigen::MatrixXd far_;               ///< (rows, B) part of the far lags in y of the current block
};

}  // namespace ricochet::contact
