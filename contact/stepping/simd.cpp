// SPDX-License-Identifier: BSD-2-Clause
#include "contact/stepping/simd.hpp"

namespace ricochet::contact::simd {

extern const InstructionSet baseline;
#ifdef RICOCHET_SIMD_X86
extern const InstructionSet avx2, avx512;
#endif

std::span<const InstructionSet* const> available() noexcept {
#ifdef RICOCHET_SIMD_X86
  static constexpr const InstructionSet* all[] = {&baseline, &avx2, &avx512};
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return std::span(all).first(1);
  if (!__builtin_cpu_supports("avx512f") || !__builtin_cpu_supports("avx512vl") ||
      !__builtin_cpu_supports("avx512dq"))
    return std::span(all).first(2);
#else
  static constexpr const InstructionSet* all[] = {&baseline};
#endif
  return all;
}

}  // namespace ricochet::contact::simd
