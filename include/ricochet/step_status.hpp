// SPDX-License-Identifier: BSD-2-Clause
#pragma once

namespace ricochet {

enum class StepStatus {
  ok,
  no_solution,
  not_finite,
  table_ended,  ///< table kernels: the step is beyond the end of the table
};

}  // namespace ricochet
