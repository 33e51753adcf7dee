// SPDX-License-Identifier: BSD-2-Clause
// What is wrong with a command line that CLI11 refuses, and what to write in its place.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <vector>

namespace ricochet::console {

/// Options of other commands, each with the command that has it: {"--vtk", "ricochet impact"}.
using Elsewhere = std::map<std::string, std::string>;

/// One line about `words`, the arguments that made `app` raise `error`: the word, and the remedy. A value of
/// --set that the shell has split at blanks is shown in quotes; an unknown option with the similar one.
std::string complaint(const CLI::App& app, const CLI::ParseError& error,
                      const std::vector<std::string>& words, const Elsewhere& elsewhere);

}  // namespace ricochet::console
