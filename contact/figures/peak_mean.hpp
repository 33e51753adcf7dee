// SPDX-License-Identifier: BSD-2-Clause
// The largest mean of a force over a window.
#pragma once

#include <cstddef>
#include <vector>

namespace ricochet::contact {

/// max over t of (1/w) ∫ F from t − w to t, for a window w of whole steps. The ripple of a series of modes
/// that is truncated at the period w has no mean, so this peak converges where that of the force itself does
/// not.
class PeakMean {
 public:
  /// @param steps  in the window, at least 1. @param step  Δ [s]
  PeakMean(std::size_t steps, double step) : step_(step), last_(steps, 0.0) {}

  /// Call it in the order of time. Steps that are left out have no force. @param time  end of the step [s]
  void observe(double time, double force);

  double peak() const { return peak_; }                                        ///< [N]
  double window() const { return step_ * static_cast<double>(last_.size()); }  ///< [s]

 private:
  void push(double force);

  double step_, time_ = 0;
  std::vector<double> last_;  ///< forces of the window, as a ring
  std::size_t next_ = 0;
  double sum_ = 0, peak_ = 0;
};

}  // namespace ricochet::contact
