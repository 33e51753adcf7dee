// SPDX-License-Identifier: BSD-2-Clause
#include "src/console/ending.hpp"

#include <fmt/format.h>

#include <csignal>
#include <cstdio>
#include <iostream>
#include <new>

#include "base/atomic_file.hpp"
#include "ricochet/error.hpp"

namespace ricochet::console {
namespace {

/// The handler is installed with SA_RESETHAND, so a second signal, such as the one raised here, ends the
/// program.
extern "C" void end(int signal) {
  base::remove_unfinished_files();
  ::raise(signal);
}

}  // namespace

void end_cleanly_on_signals() {
  struct sigaction action {};
  action.sa_handler = end;
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_NODEFER);
  for (const int signal : {SIGHUP, SIGINT, SIGTERM, SIGPIPE, SIGXCPU}) {
    struct sigaction before {};
    // A signal that is ignored, as under nohup, remains ignored.
    if (::sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_IGN) continue;
    ::sigaction(signal, &action, nullptr);
  }
  std::signal(SIGXFSZ, SIG_IGN);
}

std::string message_of(const std::exception& failure) {
  if (dynamic_cast<const std::bad_alloc*>(&failure) == nullptr) return failure.what();
  return "there is not enough memory: request fewer modes, candidates or steps, or use a larger machine";
}

int status_of(const std::exception& failure, const std::string& name) {
  fmt::print(stderr, "{}: {}\n", name, message_of(failure));
  return dynamic_cast<const InputError*>(&failure) != nullptr ? 2 : 1;
}

bool all_printed(const std::string& name) {
  if (std::cout.flush() && std::fflush(stdout) == 0) return true;
  fmt::print(stderr, "{}: cannot write to standard output: is the disk full?\n", name);
  return false;
}

}  // namespace ricochet::console
