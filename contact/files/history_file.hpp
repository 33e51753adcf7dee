// SPDX-License-Identifier: BSD-2-Clause
// Reads histories of loads and supports from text files.
#pragma once

#include <filesystem>

#include "contact/rows/history.hpp"

namespace ricochet::contact {

/// Reads a text file whose lines contain a time [s] and a factor, "t, factor", with ascending times. Empty
/// lines, lines that begin with '#', and a first line of names are skipped. Any other line throws an
/// InputError with the file and the line number.
History read_history(const std::filesystem::path& path);

}  // namespace ricochet::contact
