// SPDX-License-Identifier: BSD-2-Clause
// Reads kernel files (FORMAT.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ricochet/kernel.hpp"

namespace ricochet::kernels {

/// Reads and validates. Throws InputError, one line, on a missing, truncated, foreign or inconsistent file.
/// @param view  false: leave the skin out, which pictures alone need
Kernel read(const std::filesystem::path& path, bool view = true);

/// What a kernel file says of itself ahead of its data.
struct Header {
  std::string hash, scene, mesh_sha256;
  std::optional<std::vector<std::int64_t>> held{};  ///< of WholeSurface; none: no candidate was left out
};

/// Cheap. None when `path` is not a kernel file of a format known here.
std::optional<Header> read_header(const std::filesystem::path& path) noexcept;

/// Only the root attribute `hash`: cheap test of whether `path` is a whole kernel file and whose. Empty when
/// it is not one.
std::string read_hash(const std::filesystem::path& path) noexcept;

/// Whether `path` is a kernel file that only a newer Ricochet reads.
bool has_newer_format(const std::filesystem::path& path) noexcept;

}  // namespace ricochet::kernels
