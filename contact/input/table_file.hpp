// SPDX-License-Identifier: BSD-2-Clause
// Table files (TABLE.md).
#pragma once

#include <filesystem>

#include "contact/table/table.hpp"

namespace ricochet::contact {

/// Reads and validates. Throws InputError, one line.
Table read_table(const std::filesystem::path& path);

/// Writes a temporary file and renames it to `path`. Throws InputError if the place cannot be written.
void write_table(const Table& table, const std::filesystem::path& path);

}  // namespace ricochet::contact
