// SPDX-License-Identifier: BSD-2-Clause
// Memory that is reserved at once and used bit by bit.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <memory>
#include <utility>

#include "base/aligned.hpp"

namespace ricochet::base {

/// An array of fixed capacity. The system provides memory only for entries that have been written, so a large
/// reserve costs nothing until it is used. Entries are uninitialised until they are written. Copies have the
/// same capacity and the same entries; assignment between arrays of one capacity does not allocate.
template <class T>
class Reserved {
 public:
  explicit Reserved(std::size_t capacity = 0)
      : capacity_(capacity), entries_(Aligned<T>().allocate(capacity)) {
    // Small arrays are written now, so that a step in real time does not wait for pages.
    if (capacity * sizeof(T) <= small) std::fill_n(entries_.get(), capacity, T());
  }
  Reserved(const Reserved& other) : Reserved(other.capacity_) { *this = other; }
  Reserved(Reserved&& other) noexcept
      : capacity_(std::exchange(other.capacity_, 0)),
        size_(std::exchange(other.size_, 0)),
        entries_(std::move(other.entries_)) {}
  Reserved& operator=(const Reserved& other) {
    if (this == &other) return *this;
    if (capacity_ != other.capacity_) *this = Reserved(other.capacity_);
    size_ = other.size_;
    std::copy_n(other.entries_.get(), size_, entries_.get());
    return *this;
  }
  Reserved& operator=(Reserved&& other) noexcept {
    capacity_ = std::exchange(other.capacity_, 0);
    size_ = std::exchange(other.size_, 0);
    entries_ = std::move(other.entries_);
    return *this;
  }
  ~Reserved() = default;

  /// Sets how many entries are in use, at most the capacity. Those in use before keep their values.
  void resize(std::size_t size) noexcept {
    assert(size <= capacity_);
    size_ = size;
  }
  std::size_t size() const { return size_; }
  std::size_t capacity() const { return capacity_; }
  T* data() { return entries_.get(); }
  const T* data() const { return entries_.get(); }
  T& operator[](std::size_t k) { return entries_[k]; }
  const T& operator[](std::size_t k) const { return entries_[k]; }

 private:
  static constexpr std::size_t small = std::size_t{1} << 20;  // bytes

  std::size_t capacity_, size_ = 0;
  struct Release {
    void operator()(T* at) const noexcept { Aligned<T>().deallocate(at, 0); }
  };
  std::unique_ptr<T[], Release> entries_;
};

}  // namespace ricochet::base
