// SPDX-License-Identifier: BSD-2-Clause
// What the processor of this machine can do beyond what every x86-64 can.
#pragma once

namespace ricochet::base {

/// Vectors of four double numbers, and products with sums.
inline bool supports_avx2() noexcept {
#ifdef __x86_64__
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2");
#else
  return false;
#endif
}

/// Vectors of eight double numbers: the extensions that compilers call x86-64-v4.
inline bool supports_avx512() noexcept {
#ifdef __x86_64__
  return supports_avx2() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512vl");
#else
  return false;
#endif
}

}  // namespace ricochet::base
