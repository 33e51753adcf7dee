// SPDX-License-Identifier: BSD-2-Clause
// Command line of both programs: the same options mean the same thing in each.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace ricochet::console {

/// Called at each step with the phase, what is done and what there is to do. What it throws ends the run.
using Watch = std::function<void(const std::string& phase, std::int64_t done, std::int64_t total)>;

struct Options {
  std::filesystem::path scene;
  std::vector<std::string> overrides;  ///< --set KEY=VALUE, in order
  std::filesystem::path out;           ///< --out, else `out/` beside the scene
  bool dry_run = false;                ///< print the resolved scene and stop
  bool quiet = false;
  bool check = false;           ///< ricochet-kernel: look at all that is asked for, compute nothing
  bool vtk = false;             ///< ricochet-contact: motion for ParaView
  bool batch = false;           ///< ricochet-contact: requests on standard input, answers on standard output
  std::filesystem::path fclib;  ///< ricochet-contact: folder of complementarity problems; empty: none
  int fclib_every = 1;          ///< of the steps with contact each so many-th is written there
  Watch watch{};                ///< of programs that run an impact themselves
};

/// Which program asks: name, one-line purpose, and examples for --help.
struct Program {
  std::string name;
  std::string purpose;
  std::string examples;
  bool impacts = false;  ///< has --vtk, --batch and --fclib
  std::string keys{};    ///< what --keys prints
};

/// Parsed options, or the exit status when nothing is left to do (--help, --version, --keys: 0; bad
/// arguments: 2, with one line on stderr). `speak` false (ranks other than the first) prints nothing.
struct Parsed {
  std::optional<Options> options;
  int status = 0;
};
Parsed parse(const Program& program, int argc, const char* const* argv, bool speak = true);

}  // namespace ricochet::console
