// SPDX-License-Identifier: BSD-2-Clause
#include "tests/contact/heap_counter.hpp"

#if RICOCHET_HEAP_COUNTED
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
#endif
