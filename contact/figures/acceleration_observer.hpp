// SPDX-License-Identifier: BSD-2-Clause
// The largest acceleration of each receiver of a run.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "contact/figures/receivers.hpp"
#include "contact/figures/summary.hpp"

namespace ricochet::contact {

class AccelerationObserver {
 public:
  /// Starts with the motion at t = 0. `model` must outlive the observer.
  AccelerationObserver(const Model& model, const StepOptions& options);

  /// Call it after each step.
  void observe(const Stepper& stepper);

  std::map<std::string, AccelerationPeaks> peaks() const;

 private:
  struct Channel {
    Eigen::Vector3d velocity;  ///< at the last output sample, world axes [m/s]
    Eigen::Vector3d rest;      ///< acceleration at t = 0 [m/s²]
    double peak = 0, peak_time = 0;
    /// Mean accelerations between output samples, in the axes of the receiver [m/s²]: x, y and z of each.
    std::vector<float> means;
  };
  Eigen::Quaterniond attitude(std::size_t receiver, const Stepper& stepper) const;
  void note_peak(Channel& channel, const Eigen::Vector3d& acceleration, double time) const;

  const Model& model_;
  StepOptions options_;
  double interval_;  ///< between output samples [s]
  Receivers receivers_;
  std::vector<Channel> channels_;  ///< by receiver
};

}  // namespace ricochet::contact
