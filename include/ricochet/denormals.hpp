// SPDX-License-Identifier: BSD-2-Clause
// Arithmetic without denormal numbers, for as long as a scope lasts.
#pragma once

#include <cstdint>

namespace ricochet {

/// While an object lives, results and operands below 2.2e-308 (1.2e-38 in single precision) count as 0 on its
/// thread: processors can be a hundred times slower on them, and the tail of every decaying sound ends there.
/// The previous mode is restored at the end; rounding and exception flags are not changed; scopes nest.
/// Simulation::step and step_block create one of their own. Has no effect on processors other than x86-64 and
/// AArch64.
class FlushDenormals {
 public:
  FlushDenormals() noexcept;
  ~FlushDenormals();
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  std::uint64_t before_;  ///< the bits of the control register that this sets
};

}  // namespace ricochet
