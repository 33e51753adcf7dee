// SPDX-License-Identifier: BSD-2-Clause
// Counts all calls that allocate heap memory and, separately, those that release some, in programs that
// heap_counter.cpp is part of. It replaces malloc itself, because in glibc both Eigen and operator new call
// malloc.
#pragma once

#include <atomic>
#include <cstddef>

namespace heap_counter {
inline std::atomic<long> calls{0};
inline std::atomic<long> returns{
    0};  ///< calls that release allocated memory; destructors of Eigen also free null
}  // namespace heap_counter

// The sanitizers have their own malloc. GCC and clang tell so in their own ways.
#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define RICOCHET_HEAP_COUNTED 0
#endif
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define RICOCHET_HEAP_COUNTED 0
#endif
#ifndef RICOCHET_HEAP_COUNTED
#define RICOCHET_HEAP_COUNTED 1
#endif
