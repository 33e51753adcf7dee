// SPDX-License-Identifier: BSD-2-Clause
// Reads kernel files (docs/formats/kernel.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ricochet/kernel.hpp"

namespace ricochet::kernels {

/// Reads and validates a kernel file. Throws InputError, one line, if the file is missing, truncated, not a
/// kernel, or inconsistent. @param view  false skips the visualisation surface, which only pictures need
Kernel read(const std::filesystem::path& path, bool view = true);

/// The attributes that identify a kernel file.
struct Header {
  std::string hash, scene, mesh_sha256;
  std::optional<std::vector<std::int64_t>> held{};  ///< as in WholeSurface, if the kernel has one
  bool normal_residual = false;                     ///< as in Surface
  bool mesh_error = false;                          ///< whether errors by the mesh are estimated
};

/// Reads only the attributes and `held`. Returns no value if `path` is not a kernel file of a known format.
std::optional<Header> read_header(const std::filesystem::path& path) noexcept;

/// Returns the attribute `hash` without reading the arrays of modes, or an empty string if `path` is not a
/// complete kernel file.
std::string read_hash(const std::filesystem::path& path) noexcept;

/// Whether `path` is a kernel file whose format is newer than this program.
bool has_newer_format(const std::filesystem::path& path) noexcept;

}  // namespace ricochet::kernels
