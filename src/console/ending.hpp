// SPDX-License-Identifier: BSD-2-Clause
// The end of a program on a signal or an error.
#pragma once

#include <exception>
#include <string>

namespace ricochet::console {

/// From here on, SIGHUP, SIGINT, SIGTERM, SIGPIPE and SIGXCPU first remove the temporary files and then end
/// the program as usual: its parent sees the signal, a shell the status 128 + its number. A file that exceeds
/// the size limit (SIGXFSZ) raises an ordinary write error.
void end_cleanly_on_signals();

/// Message of a failure, in one line.
std::string message_of(const std::exception& failure);

/// Prints "NAME: message" on stderr. @return the exit status: 2 after bad input, otherwise 1.
int status_of(const std::exception& failure, const std::string& name);

/// Whether all output reached stdout; if not, prints an error on stderr.
bool all_printed(const std::string& name);

}  // namespace ricochet::console
