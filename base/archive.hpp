// SPDX-License-Identifier: BSD-2-Clause
// The state of objects as bytes. A class lists its members once, for writing and for reading:
//
//   void archive(auto& a) { a(steps_, force_); }
//
// Bytes are those of this machine. Constants and scratch are left out, so that an object reads a state only
// from an object that was made as it was. A reader checks that sizes fit, but it does not check values: who
// gives it bytes must know that they are what a writer wrote (digest.hpp).
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include "base/reserved.hpp"

namespace ricochet::base {

class Archive {
 public:
  explicit Archive(std::vector<std::byte>& out) : out_(&out) {}               ///< appends to `out`
  explicit Archive(std::span<const std::byte> in) : in_(in), reads_(true) {}  ///< reads all of `in`

  bool reads() const { return reads_; }
  /// Marks the bytes as unsuitable. All further reads change nothing.
  void fail() noexcept { failed_ = true; }
  bool failed() const { return failed_; }
  /// Whether all bytes were read and suited.
  bool complete() const { return !failed_ && in_.empty(); }

  template <class... Members>
  void operator()(Members&... members) {
    (member(members), ...);
  }

  /// `count` entries of an array.
  template <class T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void entries(T* first, std::size_t count) {
    const std::size_t size = count * sizeof(T);
    if (!reads_) {
      const auto* const from = reinterpret_cast<const std::byte*>(first);
      out_->insert(out_->end(), from, from + size);
    } else if (fits(count, sizeof(T)) && size > 0) {
      std::memcpy(first, in_.data(), size);
      in_ = in_.subspan(size);
    }
  }

 private:
  bool fits(std::uint64_t count, std::size_t of) noexcept {
    if (failed_ || count > in_.size() / of) failed_ = true;
    return !failed_;
  }
  /// Writes a size, or reads it. @return the size that the object must have
  std::uint64_t size(std::uint64_t now) {
    entries(&now, 1);
    return now;
  }

  template <class T>
  void member(T& x) {
    if constexpr (requires { x.archive(*this); }) {
      x.archive(*this);
    } else if constexpr (std::same_as<T, bool>) {
      auto value = static_cast<std::uint8_t>(x);
      entries(&value, 1);
      x = value != 0;
    } else if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      entries(&x, 1);
    } else if constexpr (requires { x.coeffs(); }) {  // a quaternion
      member(x.coeffs());
    } else {
      matrix(x);
    }
  }

  /// A dense matrix of Eigen.
  template <class T>
  void matrix(T& x) {
    const auto rows = size(static_cast<std::uint64_t>(x.rows())),
               columns = size(static_cast<std::uint64_t>(x.cols()));
    if (reads_ && (failed_ || rows != static_cast<std::uint64_t>(x.rows()) ||
                   columns != static_cast<std::uint64_t>(x.cols()))) {
      if constexpr (T::SizeAtCompileTime != -1) return fail();
      if (failed_ || (columns > 0 && !fits(rows, columns * sizeof(typename T::Scalar)))) return fail();
      x.resize(static_cast<std::ptrdiff_t>(rows), static_cast<std::ptrdiff_t>(columns));
    }
    entries(x.data(), static_cast<std::size_t>(x.size()));
  }

  template <class T, std::size_t N>
  void member(std::array<T, N>& x) {
    for (T& one : x) member(one);
  }

  template <class T, class Allocator>
  void member(std::vector<T, Allocator>& x) {
    const std::uint64_t count = size(x.size());
    constexpr bool plain = std::is_arithmetic_v<T> || std::is_enum_v<T>;
    if (reads_ && count != x.size()) {
      if (!fits(count, plain ? sizeof(T) : 1)) return;
      if constexpr (std::default_initializable<T>)
        x.resize(static_cast<std::size_t>(count));
      else
        return fail();
    }
    if constexpr (plain)
      entries(x.data(), x.size());
    else
      for (T& one : x) member(one);
  }

  template <class T>
  void member(Reserved<T>& x) {
    const std::uint64_t count = size(x.size());
    if (reads_ && count > x.capacity()) return fail();
    if (!failed_) x.resize(static_cast<std::size_t>(count));
    entries(x.data(), x.size());
  }

  std::vector<std::byte>* out_ = nullptr;
  std::span<const std::byte> in_{};
  bool reads_ = false, failed_ = false;
};

}  // namespace ricochet::base
