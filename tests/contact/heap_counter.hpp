// SPDX-License-Identifier: BSD-2-Clause
// Counts all calls that allocate heap memory and, separately, those that release some, in
// the one test file that includes this header. It replaces malloc itself, because in glibc
// both Eigen and operator new call malloc.
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
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);
void* malloc(std::size_t size) noexcept {
  ++heap_counter::calls;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  ++heap_counter::calls;
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) noexcept {
  ++heap_counter::calls;
  return __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  ++heap_counter::calls;
  return __libc_memalign(alignment, size);
}
void free(void* memory) noexcept {
  if (memory) ++heap_counter::returns;
  __libc_free(memory);
}
}
#else
#define RICOCHET_HEAP_COUNTED 0
#endif
