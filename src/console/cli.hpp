// SPDX-License-Identifier: BSD-2-Clause
// Parses command lines with CLI11, for programs whose options are not `Options`.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>

#include "src/console/arguments.hpp"

namespace ricochet::console {

/// Parses the arguments into the variables bound to `app`. Returns the exit status if the program should end:
/// 0 after --help or --version; 2 after bad arguments, with one line on stderr. Otherwise returns no value.
/// If `speak` is false, prints nothing.
std::optional<int> status_of_parsing(CLI::App& app, int argc, const char* const* argv, bool speak = true,
                                     const Elsewhere& elsewhere = {});

/// Accepts a number above 0 and at most 1e18, so that it can be converted to a 64-bit integer.
CLI::Validator above_zero();

}  // namespace ricochet::console
