// SPDX-License-Identifier: BSD-2-Clause
// A second run of bodies that turn, with speeds that are larger by half a per cent and another step. Touches
// magnify the difference: from when the runs have separated, the motion of the first is one of many.
#pragma once

#include <atomic>
#include <optional>
#include <thread>
#include <vector>

#include "contact/stepping/stepper.hpp"
#include "src/impact/runner.hpp"

namespace ricochet::impact {

class SecondRun {
 public:
  /// Begins the run in a thread of its own. `impact` must outlive it.
  explicit SecondRun(const Impact& impact);

  /// Adds a state of the first run. Call it after each of its steps.
  void observe(const contact::Stepper& first);

  /// When the surface of a body is, in both runs, apart by more than half its radius and by more than a
  /// twentieth of its way [s]: ten times as far as its speed alone makes it. No value if this does not
  /// happen. Waits until the second run has ended. @param samples  of the first run
  std::optional<double> separation(std::int64_t samples);

 private:
  using Poses = std::vector<contact::Pose>;
  void run(const std::stop_token& stop);
  void record(const contact::Stepper& stepper, std::vector<Poses>& records) const;

  const Impact& impact_;
  std::atomic<std::int64_t> samples_;  ///< after which the second run ends
  std::int64_t every_;                 ///< samples from record to record
  std::vector<double> radius_;         ///< by body [m]
  std::vector<Poses> first_, second_;
  std::jthread thread_;  ///< uses the members above
};

}  // namespace ricochet::impact
