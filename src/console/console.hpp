// SPDX-License-Identifier: BSD-2-Clause
// What a person at a terminal sees: progress bars, the table of phases, errors in one line. No MPI: ranks
// other than the first construct a quiet Console.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "src/console/options.hpp"

namespace ricochet::console {

/// Peak resident memory of this process [MiB].
double peak_memory_mib();

/// Progress of long phases on stderr and the table of their times on stdout.
///
/// On a terminal a phase is one line redrawn in place at most ten times a second; elsewhere (a log file, CI)
/// it is one line when the phase ends. A quiet console prints nothing but still measures.
class Console {
 public:
  /// @param peak  peak memory [MiB] to report at the end of a phase; under MPI a collective maximum, and then
  /// every rank's Console must see the same phases
  /// @param watch  called by `advance`, also when quiet
  explicit Console(bool quiet = false, std::function<double()> peak = peak_memory_mib, Watch watch = {});

  /// Ends the open phase, if any, and starts another. `total` 0: no known end (no percentage is shown).
  void begin(std::string name, std::int64_t total = 0);
  /// `done` of `total` so far; cheap enough for every step.
  void advance(std::int64_t done);
  /// Likewise, where the total is known only now.
  void advance(std::int64_t done, std::int64_t total);
  /// Ends the open phase; `note` is shown behind its time ("61 600 unknowns").
  void end(const std::string& note = "");
  /// One line on stdout, unless quiet.
  void say(const std::string& line);
  /// One line on stderr "warning: …", also when quiet; a program that watches finds warnings in the summary.
  void warn(const std::string& line);

  struct Phase {
    std::string name;
    double seconds = 0;
    double peak_mib = 0;  ///< highest resident memory up to the end of the phase
    std::string note;
  };
  const std::vector<Phase>& phases() const { return phases_; }

  /// The table of phases, a line each, with a total; ready to print.
  static std::string table(const std::vector<Phase>& phases);

 private:
  void draw(bool last);
  bool quiet_;
  std::function<double()> peak_;
  Watch watch_;
  bool terminal_;
  bool open_ = false;
  std::int64_t total_ = 0, done_ = 0;
  double started_ = 0, drawn_ = 0;
  std::string name_;
  std::vector<Phase> phases_;
};

}  // namespace ricochet::console
