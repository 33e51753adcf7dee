// SPDX-License-Identifier: BSD-2-Clause
// Command lines by CLI11, for programs that have other options than `Options`.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>

namespace ricochet::console {

/// Parses into what `app` is bound to. The exit status when nothing is left to do (--help, --version: 0; bad
/// arguments: 2, with one line on stderr); none when the program is to go on. `speak` false prints nothing.
std::optional<int> status_of_parsing(CLI::App& app, int argc, const char* const* argv, bool speak = true);

/// Of an option: a number above 0, and not beyond 1e18, so that whole numbers fit.
CLI::Validator above_zero();

}  // namespace ricochet::console
