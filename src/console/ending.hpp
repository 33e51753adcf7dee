// SPDX-License-Identifier: BSD-2-Clause
// Ends a program on a signal or an error.
#pragma once

#include <exception>
#include <string>

namespace ricochet::console {

/// After this call, SIGHUP, SIGINT, SIGTERM, SIGPIPE and SIGXCPU first remove the temporary files and then
/// end the program in the usual way: its parent sees the signal, and a shell reports the status 128 + its
/// number. A file that exceeds the size limit (SIGXFSZ) causes an ordinary write error.
void end_cleanly_on_signals();

/// The message of a failure, for one line of output.
std::string message_of(const std::exception& failure);

/// Prints "NAME: message" on stderr. @return the exit status: 2 for an InputError, otherwise 1
int status_of(const std::exception& failure, const std::string& name);

/// Returns whether all output has reached stdout. If not, prints an error on stderr.
bool all_printed(const std::string& name);

}  // namespace ricochet::console
