// SPDX-License-Identifier: BSD-2-Clause
// The loop over time steps.
#pragma once

#include <cmath>
#include <concepts>
#include <cstdint>

#include "ricochet/step_status.hpp"

namespace ricochet::contact {

/// Number of steps in `duration` [s] at `rate` [Hz].
inline std::int64_t step_count(double duration, double rate) { return std::llround(duration * rate); }

struct StepsMade {
  std::int64_t steps = 0;
  StepStatus status = StepStatus::ok;
};

/// Advances `stepper` by `steps` contact steps, a whole number of output samples, and stops at the first step
/// that fails. Each observer is called with the number of contact steps made, after every step that succeeds.
/// It may throw to end the run, or return a bool: false ends the run after this step.
template <class Stepper, class... Observers>
StepsMade run_steps(Stepper& stepper, std::int64_t steps, Observers&&... observers) {
  StepsMade made;
  const std::int64_t first = stepper.steps();
  const auto goes_on = [&](auto& observer) -> bool {
    if constexpr (std::same_as<decltype(observer(made.steps)), bool>) return observer(made.steps);
    observer(made.steps);
    return true;
  };
  bool more = true;
  while (more && made.steps < steps) {
    if ((made.status = stepper.step()) != StepStatus::ok) break;
    made.steps = stepper.steps() - first;
    more = (goes_on(observers) & ... & true);
  }
  return made;
}

}  // namespace ricochet::contact
