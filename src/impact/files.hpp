// SPDX-License-Identifier: BSD-2-Clause
// Writes the files of an impact while it runs: result, motion for ParaView, sound, complementarity problems.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>

#include "contact/files/fclib.hpp"
#include "contact/files/motion_file.hpp"
#include "contact/files/recorder.hpp"
#include "src/impact/runner.hpp"
#include "src/sound/receiver_sounds.hpp"

namespace ricochet::impact {

struct ImpactFileOptions {
  std::filesystem::path folder;
  bool motion = false;
  double snapshots_mb = 0;  ///< size up to which snapshots are kept although the scene asks for none [MB]
  std::filesystem::path problems{};  ///< folder of complementarity problems; empty: none
  int problems_every = 1;            ///< every n-th step with contact is written
};

class ImpactFiles : public ImpactObserver {
 public:
  explicit ImpactFiles(ImpactFileOptions options) : options_(std::move(options)) {}

  void prepared(const Impact& impact) override;
  bool needs_steps(const Impact& impact) const override;
  void started(const Impact& impact, const contact::Stepper& stepper) override;
  void stepped(const contact::Stepper& stepper) override;
  void at_rest(const Impact& impact, const contact::Equilibrium& equilibrium) override;

  /// Gives all files their final names and writes the summary, with the sounds and the identifier of the run;
  /// waits while another run writes files of the same names. No member but the names may be used afterwards.
  /// @param started  for the duration of the run in the summary
  /// @return a line if the files of a run of another scene were replaced; otherwise empty
  std::string commit(ImpactSummary& summary, std::chrono::steady_clock::time_point started);

  std::filesystem::path result() const { return with(".result.h5"); }
  std::filesystem::path summary() const { return with(".summary.json"); }
  std::optional<std::filesystem::path> motion() const;  ///< the file to open; no value: not requested
  std::optional<int> problems() const;                  ///< number written; no value: not requested

 private:
  std::filesystem::path with(const char* ending) const;
  bool adds_snapshots(const Impact& impact) const;
  const contact::RecorderOptions& recorder_options(const Impact& impact);

  ImpactFileOptions options_;
  std::filesystem::path stem_;       ///< start of all file names
  contact::RecorderOptions result_;  ///< what identifies the run
  std::optional<contact::Recorder> recorder_;
  std::optional<contact::MotionFile> motion_;
  std::optional<sound::ReceiverSounds> sounds_;
  std::optional<contact::ProblemFiles> problems_;
};

}  // namespace ricochet::impact
