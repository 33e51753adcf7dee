// SPDX-License-Identifier: BSD-2-Clause
// The command line of both programs: an option has the same meaning in each of them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace ricochet::console {

/// Called at each step with the phase, the amount done and the total. The run ends if it throws.
using Watch = std::function<void(const std::string& phase, std::int64_t done, std::int64_t total)>;

struct Options {
  std::filesystem::path scene;
  std::vector<std::string> overrides;  ///< --set KEY=VALUE, in order
  std::filesystem::path out;           ///< --out; default: `out/` beside the scene
  bool dry_run = false;                ///< print the resolved scene and stop
  bool quiet = false;
  bool check = false;           ///< ricochet-kernel: check the request, compute nothing
  bool verify = false;          ///< ricochet-kernel: count the modes of stored kernels again
  bool plan = false;            ///< ricochet-kernel: state memory and time on 1, 2, 4, … ranks and stop
  double view_mib = 0;          ///< ricochet-kernel: size up to which a surface is kept unasked [MiB]
  double snapshots_mb = 0;      ///< ricochet-contact: size up to which snapshots are kept unasked [MB]
  bool vtk = false;             ///< ricochet-contact: write the motion for ParaView
  bool batch = false;           ///< ricochet-contact: requests on stdin, answers on stdout
  std::filesystem::path fclib;  ///< ricochet-contact: folder of complementarity problems; empty: none
  std::filesystem::path write_scene;  ///< ricochet-contact: file for the scene with chosen settings
  int fclib_every = 1;                ///< every n-th step with contact is written
  Watch watch{};                      ///< for programs that call an impact as a function
};

/// The program whose command line is parsed.
struct Program {
  std::string name;
  std::string purpose;
  std::string examples;
  bool impacts = false;  ///< has --vtk, --batch and --fclib
  std::string keys{};    ///< text that --keys prints
};

/// Parsed options, or the exit status if the program should end: 0 after --help, --version or --keys; 2 after
/// bad arguments, with one line on stderr. If `speak` is false, as on ranks other than the first, nothing is
/// printed.
struct Parsed {
  std::optional<Options> options;
  int status = 0;
};
Parsed parse(const Program& program, int argc, const char* const* argv, bool speak = true);

}  // namespace ricochet::console
