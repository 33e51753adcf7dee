// SPDX-License-Identifier: BSD-2-Clause
// How fast a force rises to its peak.
#pragma once

#include <vector>

namespace ricochet::contact {

/// The peak of a force and the time in which it rose from half its peak, for any number of steps in bounded
/// memory.
class PeakRise {
 public:
  /// Call it for each step, in the order of time. @param time  end of the step [s]. @param force  [N], ≥ 0
  void observe(double time, double force);

  double peak() const { return peak_; }  ///< [N]; 0 if there was no force
  double time() const { return time_; }  ///< of the peak [s]
  /// Time from the last step before the peak with less than half of it to the peak [s].
  double rise() const { return rise_; }

 private:
  struct Low {
    double force, time;
  };
  /// Later forces were all larger than `force`, up to 2 %. Ascending in both members, so the last entry below
  /// any force is the last time at which the force was below it.
  std::vector<Low> lows_{{0, 0}};
  double peak_ = 0, time_ = 0, rise_ = 0;
};

}  // namespace ricochet::contact
