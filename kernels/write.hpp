// SPDX-License-Identifier: BSD-2-Clause
// Writes kernel files (FORMAT.md).
#pragma once

#include <filesystem>

#include "ricochet/kernel.hpp"

namespace ricochet::kernels {

/// Writes `kernel` beside `path` and renames it: a partial file never has the final name.
/// Throws InputError when the place can't be written.
void write(const Kernel& kernel, const std::filesystem::path& path);

}  // namespace ricochet::kernels
