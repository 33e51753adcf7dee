// SPDX-License-Identifier: BSD-2-Clause
// Table files (TABLE.md).
#pragma once

#include <filesystem>

#include "contact/table/table.hpp"

namespace ricochet::contact {

/// Reads and validates. Throws InputError, one line.
Table read_table(const std::filesystem::path& path);

/// Writes beside `path` and renames. Throws InputError when the place can't be written.
void write_table(const Table& table, const std::filesystem::path& path);

}  // namespace ricochet::contact
