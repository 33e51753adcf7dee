// SPDX-License-Identifier: BSD-2-Clause
// A digest of 128 bits, by which data are told apart. It guards against mistakes and damage, not against
// forgery.
//
// Each lane takes a word w by h ← rot((h ⊕ w) p), which is one-to-one both in h and in w. Two streams of the
// same length that differ in a single word therefore always differ in both lanes.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <type_traits>

namespace ricochet::base {

class Digest {
 public:
  using Value = std::array<std::uint64_t, 2>;

  /// Bytes with their number.
  void add(const void* bytes, std::size_t size) noexcept {
    take(size);
    const auto* at = static_cast<const char*>(bytes);
    for (; size >= sizeof(std::uint64_t); size -= sizeof(std::uint64_t), at += sizeof(std::uint64_t))
      take(word(at, sizeof(std::uint64_t)));
    if (size > 0) take(word(at, size));
  }
  void add(std::string_view text) noexcept { add(text.data(), text.size()); }
  template <class T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void add(T x) noexcept { take(word(&x, sizeof x)); }
  void add(const Value& value) noexcept {
    for (const std::uint64_t x : value) take(x);
  }

  Value value() const noexcept {
    Value out = lane_;
    for (std::uint64_t& h : out) {
      h ^= h >> 33;
      h *= 0xff51afd7ed558ccd;
      h ^= h >> 33;
    }
    return out;
  }

 private:
  static std::uint64_t word(const void* at, std::size_t size) noexcept {
    std::uint64_t out = 0;
    std::memcpy(&out, at, size);
    return out;
  }
  void take(std::uint64_t w) noexcept {
    lane_[0] = std::rotl((lane_[0] ^ w) * 0x9e3779b97f4a7c15, 29);
    lane_[1] = std::rotl((lane_[1] ^ w) * 0xc2b2ae3d27d4eb4f, 43);
  }

  Value lane_{0x243f6a8885a308d3, 0x13198a2e03707344};
};

}  // namespace ricochet::base
