// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/simd.hpp"

namespace ricochet::contact::simd {

extern const InstructionSet baseline;
#ifdef RICOCHET_SIMD_X86
extern const InstructionSet avx2, avx512;
#endif

const InstructionSet* const* available(std::size_t& count) noexcept {
#ifdef RICOCHET_SIMD_X86
  static const InstructionSet* const all[] = {&baseline, &avx2, &avx512};
  count = 1;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    count = 2;
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
        __builtin_cpu_supports("avx512dq"))
      count = 3;
  }
#else
  static const InstructionSet* const all[] = {&baseline};
  count = 1;
#endif
  return all;
}

const InstructionSet& best() noexcept {
  std::size_t count = 0;
  const InstructionSet* const* all = available(count);
  return *all[count - 1];
}

}  // namespace ricochet::contact::simd
