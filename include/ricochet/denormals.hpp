// SPDX-License-Identifier: BSD-2-Clause
// Arithmetic without denormal numbers within a scope.
#pragma once

#include <cstdint>

namespace ricochet {

/// While an object exists, results and operands below 2.2e-308 (1.2e-38 in single precision) count as 0 on
/// its thread. Processors can be a hundred times slower on such numbers, and every decaying sound ends in
/// them. The destructor restores the previous mode. Rounding and exception flags do not change, and scopes
/// may be nested. Simulation::step and step_block create an object of their own. Has no effect on processors
/// other than x86-64 and AArch64.
class FlushDenormals {
 public:
  FlushDenormals() noexcept;
  ~FlushDenormals();
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  std::uint64_t before_;  ///< previous values of the bits that this class sets in the control register
};

}  // namespace ricochet
