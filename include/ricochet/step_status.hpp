// SPDX-License-Identifier: BSD-2-Clause
#pragma once

namespace ricochet {

enum class StepStatus {
  ok,
  no_solution,
  not_finite,
  table_ended,  ///< sampled responses: the step is beyond their end
  crowded,      ///< finite rotations: more points may touch at once than a step can hold
};

}  // namespace ricochet
