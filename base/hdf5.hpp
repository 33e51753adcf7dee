// SPDX-License-Identifier: BSD-2-Clause
// Types shared by the readers and writers of HDF5 files: shapes, element types and the owner of an
// identifier. No HDF5 header is needed here; handles never leave these classes.
//
// The error messages of HDF5 and its closing of files at program exit are switched off permanently.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace ricochet::base::hdf5 {

using Shape = std::vector<std::size_t>;

/// Matches any length in an expected shape.
inline constexpr std::size_t any = static_cast<std::size_t>(-1);

/// "(5, 3)"; a dimension `any` is written "*".
std::string to_string(const Shape& shape);

template <class T>
concept Element = std::same_as<T, double> || std::same_as<T, float> || std::same_as<T, std::int64_t>;

/// Owner of one HDF5 identifier.
class Id {
 public:
  Id() = default;
  explicit Id(std::int64_t raw) : raw_(raw) {}
  Id(Id&& other) noexcept : raw_(std::exchange(other.raw_, -1)) {}
  Id& operator=(Id&& other) noexcept {
    std::swap(raw_, other.raw_);
    return *this;
  }
  ~Id() { reset(); }

  std::int64_t get() const { return raw_; }
  bool valid() const { return raw_ >= 0; }
  std::int64_t release() noexcept { return std::exchange(raw_, -1); }
  void reset() noexcept;

 private:
  std::int64_t raw_ = -1;
};

}  // namespace ricochet::base::hdf5
