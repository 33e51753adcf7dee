// SPDX-License-Identifier: BSD-2-Clause
// Reads table files (docs/formats/responses.md).
#pragma once

#include <filesystem>

#include "contact/table/table.hpp"

namespace ricochet::contact {

/// Reads and validates a table file. Throws a one-line InputError.
Table read_table(const std::filesystem::path& path);

}  // namespace ricochet::contact
