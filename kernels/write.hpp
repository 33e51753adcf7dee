// SPDX-License-Identifier: BSD-2-Clause
// Writes kernel files (docs/formats/kernel.md).
#pragma once

#include <filesystem>

#include "ricochet/kernel.hpp"

namespace ricochet::kernels {

/// Writes `kernel` under a temporary name and renames it to `path`: a partial file never has the final name.
/// Throws InputError if the place cannot be written.
void write(const Kernel& kernel, const std::filesystem::path& path);

}  // namespace ricochet::kernels
