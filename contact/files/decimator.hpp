// SPDX-License-Identifier: BSD-2-Clause
// Takes every n-th row of a sampled signal, without aliases.
//
//   y_k = Σ_j h_j x_{nk−j},   h_j = w(j) sinc(j/n)/n,   |j| ≤ 33 n,   w: Kaiser's window for 100 dB
//
// The filter is symmetric, so it delays nothing. It keeps frequencies below 0.45 of the output rate within
// 1e-5, and removes those above 0.55 of it to 1e-5; half of the output rate is in the middle of this
// transition. A straight line remains exactly the same. Before its first row, the signal is continued by a
// line of a given slope; after its last row, it is continued by its point reflection.
// Source: Kaiser 1974.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace ricochet::contact {

class Decimator {
 public:
  /// Receives the number of an input row and the output there.
  using Take = std::function<void(std::int64_t row, std::span<const double> values)>;

  /// @param every  n, at least 1; 1 keeps every row as it is
  /// @param slope  of each column before the first row [per row]
  Decimator(int every, std::vector<double> slope);

  /// Adds a row and emits the output that this completes.
  void push(std::span<const double> row, const Take& take);
  /// Emits the rest of the output. No row may follow.
  void finish(const Take& take);

 private:
  const double* row(std::int64_t number) const;
  void emit(const Take& take);

  std::int64_t every_, half_;   ///< n, and the length of each side of the filter
  std::vector<double> filter_;  ///< h_j for j = 0 … half_
  std::vector<double> slope_, out_;
  std::vector<double> held_;          ///< (rows, columns) the latest rows and continuations
  std::int64_t first_ = 0, end_ = 0;  ///< numbers of the first row in held_, and after the last one
  std::int64_t next_ = 0;             ///< number of the next output
};

}  // namespace ricochet::contact
