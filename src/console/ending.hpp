// SPDX-License-Identifier: BSD-2-Clause
// How a program ends when it is told to, or when it fails.
#pragma once

#include <exception>
#include <string>

namespace ricochet::console {

/// From here on SIGHUP, SIGINT, SIGTERM, SIGPIPE and SIGXCPU end the program as they would, once its
/// temporary files are removed: its parent sees the signal, a shell the status 128 + its number. A file that
/// would be longer than the limit (SIGXFSZ) can't be written, and is told as such.
void end_cleanly_on_signals();

/// What happened, in one line.
std::string told(const std::exception& failure);

/// Prints "NAME: what happened" on stderr. @return the status to end with: 2 after bad input, 1 otherwise.
int status_of(const std::exception& failure, const std::string& name);

/// Whether all that was printed went out; else it says so on stderr.
bool all_printed(const std::string& name);

}  // namespace ricochet::console
