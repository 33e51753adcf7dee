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

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // the sanitizers have their own malloc
#define RICOCHET_HEAP_COUNTED 1
#else
#define RICOCHET_HEAP_COUNTED 0
#endif
