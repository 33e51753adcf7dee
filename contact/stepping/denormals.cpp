// SPDX-License-Identifier: BSD-2-Clause
#include "ricochet/denormals.hpp"

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace ricochet {
namespace {

#if defined(__x86_64__)
// MXCSR: flush results to zero, denormals are zeros
constexpr std::uint64_t flushing = 0x8040;
std::uint64_t mode() noexcept { return _mm_getcsr(); }
void set_mode(std::uint64_t value) noexcept { _mm_setcsr(static_cast<unsigned>(value)); }
#elif defined(__aarch64__)
// FPCR: FZ, operands and results
constexpr std::uint64_t flushing = std::uint64_t{1} << 24;
std::uint64_t mode() noexcept {
  std::uint64_t value = 0;
  asm volatile("mrs %0, fpcr" : "=r"(value));
  return value;
}
void set_mode(std::uint64_t value) noexcept { asm volatile("msr fpcr, %0" : : "r"(value) : "memory"); }
#else
constexpr std::uint64_t flushing = 0;
std::uint64_t mode() noexcept { return 0; }
void set_mode(std::uint64_t) noexcept {}
#endif

}  // namespace

FlushDenormals::FlushDenormals() noexcept : before_(mode() & flushing) { set_mode(mode() | flushing); }

FlushDenormals::~FlushDenormals() { set_mode((mode() & ~flushing) | before_); }

}  // namespace ricochet
