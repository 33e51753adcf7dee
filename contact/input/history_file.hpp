// SPDX-License-Identifier: BSD-2-Clause
// Reads histories of loads and supports from text files.
#pragma once

#include <filesystem>

#include "contact/model/history.hpp"

namespace ricochet::contact {

/// Reads a text file with a time [s] and a factor a line, "t, factor", times ascending. Empty lines, lines
/// that begin with '#', and a first line of names are skipped. Throws InputError, one line with the file and
/// the line's number, on any other line.
History read_history(const std::filesystem::path& path);

}  // namespace ricochet::contact
