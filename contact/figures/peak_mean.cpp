// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/peak_mean.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace ricochet::contact {

void PeakMean::observe(double time, double force) {
  const double left_out = std::round((time - time_) / step_) - 1;
  time_ = time;
  if (left_out >= static_cast<double>(last_.size())) {
    std::ranges::fill(last_, 0.0);
    sum_ = 0;
  } else {
    for (double k = 0; k < left_out; ++k) push(0);
  }
  push(force);
  peak_ = std::max(peak_, sum_ / static_cast<double>(last_.size()));
}

void PeakMean::push(double force) {
  sum_ += force - last_[next_];
  last_[next_] = force;
  if (++next_ < last_.size()) return;
  next_ = 0;
  sum_ = std::accumulate(last_.begin(), last_.end(), 0.0);  // so that round-off does not pile up
}

}  // namespace ricochet::contact
