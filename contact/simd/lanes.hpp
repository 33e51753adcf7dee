// SPDX-License-Identifier: BSD-2-Clause
// Registers of the instruction set for which a file is compiled. Everything is in an unnamed namespace, and
// only types of <utility> are used: a linker could take an inline function from such a file and run it on a
// processor that lacks the instructions.
#pragma once

#include <cstddef>
#include <utility>

namespace ricochet::contact::simd {
namespace {

#if defined(__AVX512F__)
constexpr std::size_t bytes = 64;
#elif defined(__AVX2__)
constexpr std::size_t bytes = 32;
#else
constexpr std::size_t bytes = 16;
#endif

/// A register of T, or `count` of them.
template <class T, std::size_t count = bytes / sizeof(T)>
struct Lanes {
  static constexpr std::size_t size = count;
  typedef T type __attribute__((vector_size(count * sizeof(T)), aligned(alignof(T)), may_alias));
  static type load(const T* at) { return *reinterpret_cast<const type*>(at); }
  static void store(T* at, type x) { *reinterpret_cast<type*>(at) = x; }
  /// |x|: without the bits of the signs, which takes one instruction.
  static type magnitude(type x) {
    typedef long long bits __attribute__((vector_size(count * sizeof(T))));
    static_assert(sizeof(T) == sizeof(long long));
    return reinterpret_cast<type>(reinterpret_cast<bits>(x) & 0x7fffffffffffffffLL);
  }
  static T sum(type x) {
    T total = 0;
    for (std::size_t k = 0; k < count; ++k) total += x[k];
    return total;
  }
  /// Lane j is the sum of the entries j and j ^ s of a, or of b if j has bit `s`.
  template <std::size_t s, std::size_t... j>
  static type fold(type a, type b, std::index_sequence<j...>) {
    return __builtin_shufflevector(a, b, ((j & s) != 0 ? count + j : j)...) +
           __builtin_shufflevector(a, b, ((j & s) != 0 ? count + (j ^ s) : j ^ s)...);
  }
  /// Lane j is the sum of the register x[j], for `count` registers. Overwrites x.
  template <std::size_t s = 1>
  static type sums(type* x) {
    if constexpr (s == count) {
      return x[0];
    } else {
      for (std::size_t k = 0; k < count / (2 * s); ++k)
        x[k] = fold<s>(x[2 * k], x[2 * k + 1], std::make_index_sequence<count>());
      return sums<2 * s>(x);
    }
  }
  /// Lane j is the entry j of a, or j ^ s of b if j has bit `s`.
  template <std::size_t s, std::size_t... j>
  static type take(type a, type b, std::index_sequence<j...>) {
    return __builtin_shufflevector(a, b, ((j & s) != 0 ? count + (j ^ s) : j)...);
  }
  template <std::size_t s, std::size_t... j>
  static type leave(type a, type b, std::index_sequence<j...>) {
    return __builtin_shufflevector(a, b, ((j & s) != 0 ? count + j : j ^ s)...);
  }
  /// Exchanges the lanes j of x[k] and k of x[j], for `count` registers.
  template <std::size_t s = 1>
  static void transpose(type* x) {
    if constexpr (s < count) {
      for (std::size_t k = 0; k < count; ++k) {
        if ((k & s) != 0) continue;
        const type a = x[k], b = x[k + s];
        x[k] = take<s>(a, b, std::make_index_sequence<count>());
        x[k + s] = leave<s>(a, b, std::make_index_sequence<count>());
      }
      transpose<2 * s>(x);
    }
  }
};

}  // namespace
}  // namespace ricochet::contact::simd
