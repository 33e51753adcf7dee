// SPDX-License-Identifier: BSD-2-Clause
// Arrays for vector instructions. They begin at a multiple of the widest register, which is a cache line: a
// load that crosses two lines costs two.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace ricochet::base {

template <class T>
struct Aligned {
  using value_type = T;
  static constexpr std::align_val_t cache_line{64};

  Aligned() = default;
  template <class Other>
  Aligned(const Aligned<Other>&) noexcept {}

  T* allocate(std::size_t count) {
    if (count > static_cast<std::size_t>(-1) / sizeof(T)) throw std::bad_array_new_length();
    return static_cast<T*>(::operator new(count * sizeof(T), cache_line));
  }
  void deallocate(T* at, std::size_t) noexcept { ::operator delete(at, cache_line); }
  bool operator==(const Aligned&) const = default;
};

template <class T>
using AlignedVector = std::vector<T, Aligned<T>>;

}  // namespace ricochet::base
