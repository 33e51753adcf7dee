// SPDX-License-Identifier: BSD-2-Clause
// Arithmetic without denormal numbers, for as long as a scope lasts.
#pragma once

#include <cstdint>

namespace ricochet {

/// Results and operands below 2.2e-308 (1.2e-38 in single precision) count as 0 on this thread while it
/// lives: processors can be a hundred times slower on them, and the tail of every decaying sound ends there.
/// The mode before it is restored, rounding and exception flags are left alone; scopes nest. Simulation::step
/// and step_block have one of their own. Does nothing on processors other than x86-64 and AArch64.
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
