// SPDX-License-Identifier: BSD-2-Clause
// Command lines by CLI11, for programs whose options are not `Options`.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>

namespace ricochet::console {

/// Parses the arguments into the variables bound to `app`. Returns the exit status if the program should end
/// (--help, --version: 0; bad arguments: 2, with one line on stderr), otherwise none. If `speak` is false,
/// nothing is printed.
std::optional<int> status_of_parsing(CLI::App& app, int argc, const char* const* argv, bool speak = true);

/// Validator of an option: a number above 0 and at most 1e18, so that whole numbers fit.
CLI::Validator above_zero();

}  // namespace ricochet::console
