// SPDX-License-Identifier: BSD-2-Clause
// The matrices of look-ahead blocks between the rows that may touch. Those of a row are computed when it is
// first needed, so that rows that always stay open need neither time nor memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "base/reserved.hpp"
#include "contact/simd/simd.hpp"
#include "contact/stepping/step_system.hpp"

namespace ricochet::contact {

/// Rounds a bound up to single precision, so that it remains a bound. Half the memory to read pays: the
/// bounds of all rows do not fit into the caches.
inline float rounded_up(double bound) {
  using Limits = std::numeric_limits<float>;
  return bound == 0 ? 0 : std::max(static_cast<float>(bound * (1 + 2.0 * Limits::epsilon())), Limits::min());
}

template <class T>
class BlockMatrices {
 public:
  /// @param steps  L   @param step  Δ [s]   @param at_once  up to this many bytes of all matrices, those of
  /// all rows are computed here, so that no step has to wait for them
  BlockMatrices(const StepSystem& system, int steps, double step, double at_once);

  /// Computes the matrices of a row unless they are known. Does not allocate. O(n N L).
  void need(int row) noexcept;

  /// Place of a needed row in the matrices.
  int place(int row) const noexcept { return place_[row]; }
  /// (L, width) M_d of a needed row, by place.
  const T* lags(int row) const { return &lag_[static_cast<std::size_t>(place(row)) * length_ * width_]; }
  /// M_0 of two needed rows.
  double M(int row, int other) const {
    return M_[static_cast<std::size_t>(place(row)) * width_ + static_cast<std::size_t>(place(other))];
  }
  /// (places, width) over all rows: largest |M_d,ij| over all lags, |R_ij| added to lag 0.
  const float* influence() const { return influence_.data(); }
  /// (places, width) over all rows: R + Σ B Bᵀ/ω² of elastic modes.
  const float* flexibility() const { return flexibility_.data(); }

 private:
  const Model& model_;
  const simd::Loops<double>& loops_;
  std::size_t length_, width_, modes_;
  base::AlignedVector<double> B_;        ///< (n, modes)
  base::AlignedVector<double> factors_;  ///< (L + 1, modes) of B Bᵀ in M_d, and in the flexibility
  std::vector<int> all_;                 ///< rows, ascending
  std::vector<int> rows_;                ///< by place
  std::vector<int> place_;               ///< of each row, or −1
  base::AlignedVector<double> x_, sum_;  ///< (L + 1, modes), (L + 1, width) scratch
  base::Reserved<T> lag_;
  base::Reserved<float> influence_, flexibility_;
  base::Reserved<double> M_;
};

}  // namespace ricochet::contact
