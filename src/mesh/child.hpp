// SPDX-License-Identifier: BSD-2-Clause
// Another program of Ricochet as a child process, which may die for any cause.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace ricochet::mesh {

/// How a child process ended.
struct Ending {
  int status = 0;           ///< as of waitpid
  bool stuck = false;       ///< it was killed because it had stopped working
  double peak_bytes = 0;    ///< its largest resident memory
  std::string last_line{};  ///< its last error message, otherwise the last line that it wrote to stderr
};

/// A child that uses no processor time for so long is killed [s]. It waits for a lock that nobody releases.
inline constexpr int longest_idle_s = 60;

/// The program `name`, which is installed in libexec/ricochet beside the folder of this program.
std::filesystem::path helper_program(const std::string& name);

/// Runs a program until it ends, without a shell and with the signals of a new process. Neither MPI nor the
/// threads of this process reach it: it is executed, not only forked.
/// @param input     what it reads from stdin
/// @param arguments  of the program
/// @param received  called with what it writes to stdout. If it throws, the child is killed
/// @param idle_s    seconds without processor time after which it is killed
/// Throws std::runtime_error if the program cannot be started.
Ending run_child(const std::filesystem::path& program, const std::string& input,
                 const std::function<void(const char* data, std::size_t size)>& received,
                 int idle_s = longest_idle_s, const std::vector<std::string>& arguments = {});

}  // namespace ricochet::mesh
