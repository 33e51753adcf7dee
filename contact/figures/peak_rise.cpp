// SPDX-License-Identifier: BSD-2-Clause
#include "contact/figures/peak_rise.hpp"

#include <algorithm>

namespace ricochet::contact {

void PeakRise::observe(double time, double force) {
  // Forces that differ by less than this share one entry, so there are at most log(largest/least)/log 1.02.
  constexpr double same = 1.02;
  while (!lows_.empty() && lows_.back().force >= force) lows_.pop_back();
  if (!lows_.empty() && force <= same * lows_.back().force)
    lows_.back().time = time;
  else
    lows_.push_back({force, time});
  if (!(force > peak_)) return;
  peak_ = force;
  time_ = time;
  const auto half = std::ranges::lower_bound(lows_, 0.5 * force, {}, &Low::force);
  rise_ = half == lows_.begin() ? 0 : time - std::prev(half)->time;
}

}  // namespace ricochet::contact
