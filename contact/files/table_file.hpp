// SPDX-License-Identifier: BSD-2-Clause
// Reads files of sampled responses (docs/formats/responses.md).
#pragma once

#include <filesystem>

#include "contact/table/table.hpp"

namespace ricochet::contact {

/// Reads and validates such a file. Throws a one-line InputError.
Table read_table(const std::filesystem::path& path);

}  // namespace ricochet::contact
