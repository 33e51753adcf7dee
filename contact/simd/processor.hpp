// SPDX-License-Identifier: BSD-2-Clause
// What the processor of this machine can do beyond what every x86-64 can.
#pragma once

namespace ricochet::contact::simd {

#ifdef RICOCHET_SIMD_X86
inline bool supports_avx2() noexcept {
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
}

inline bool supports_avx512() noexcept {
  return supports_avx2() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
         __builtin_cpu_supports("avx512dq");
}
#endif

}  // namespace ricochet::contact::simd
