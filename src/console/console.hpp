// SPDX-License-Identifier: BSD-2-Clause
// Output on the terminal: progress bars, times of phases and one-line messages. Independent of MPI: ranks
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

/// Time since some moment [s].
double now();

/// A time as text: seconds, minutes or hours.
std::string duration_of(double seconds);

/// Shows the progress of long phases on stderr, with their times and memory.
///
/// On a terminal, a phase is one line that is redrawn in place at most ten times a second. Otherwise, as in a
/// log file, it is one line at the end of the phase. A quiet console prints only warnings, but still
/// measures.
class Console {
 public:
  /// @param peak  returns the peak memory [MiB] to report at the end of a phase. Under MPI it is a collective
  /// maximum, so the Consoles of all ranks must have the same phases.
  /// @param watch  called by `advance`, even if the console is quiet
  explicit Console(bool quiet = false, std::function<double()> peak = peak_memory_mib, Watch watch = {});

  /// Ends the open phase, if any, and starts another. If `total` is 0, its length is unknown and no
  /// percentage is shown.
  void begin(std::string name, std::int64_t total = 0);
  /// Reports that `done` of `total` is finished. Cheap enough to be called at every step.
  void advance(std::int64_t done);
  /// The same, for a total that only becomes known during the phase.
  void advance(std::int64_t done, std::int64_t total);
  /// Ends the open phase; `note` is shown after its time ("61 600 unknowns").
  void end(const std::string& note = "");
  /// Prints one line on stdout, unless the console is quiet.
  void say(const std::string& line);
  /// Prints one line "warning: …" on stderr, even if the console is quiet. With a watch, prints nothing: the
  /// calling program finds the warnings in the summary.
  void warn(const std::string& line);

  struct Phase {
    std::string name;
    double seconds = 0;
    double peak_mib = 0;  ///< peak resident memory up to the end of the phase
    std::string note;
  };
  const std::vector<Phase>& phases() const { return phases_; }

  /// Name, time, peak memory and note of a phase as one line, aligned with those of other phases.
  static std::string line(const Phase& phase);
  /// Prints a last line on stderr: the time of all phases and their peak memory.
  void total();

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
