// SPDX-License-Identifier: BSD-2-Clause
// Sound files of the receivers of a model, from their velocities at every step.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "contact/figures/receivers.hpp"
#include "contact/figures/summary.hpp"
#include "src/scene/data/output.hpp"

namespace ricochet::sound {

class ReceiverSounds {
 public:
  /// @param players  the sound for players, of these receivers
  /// Throws InputError in the same cases as check_length, and if its high-pass filter does not fit the rate.
  ReceiverSounds(const std::vector<contact::Model::Receiver>& receivers, std::int64_t steps, double rate_hz,
                 const std::optional<scene::Sound>& players = {});

  /// Must be called with the motion at t = 0 and then after each step.
  void record(const contact::Receivers& motion);

  /// Writes `<stem>.<receiver>.wav` for each receiver, with the identifier `run` in its comment. Throws
  /// InputError in the same cases as write_wav.
  /// @return the files by receiver
  std::map<std::string, contact::Sound> write(const std::filesystem::path& stem,
                                              const std::string& run = {}) const;

  /// Writes `<stem>.wav`, the sound for players. Throws as `write`. @return no value if the scene has none
  std::optional<contact::Sound> write_for_players(const std::filesystem::path& stem) const;

 private:
  double rate_hz_;
  std::optional<scene::Sound> players_;
  std::vector<std::string> name_;
  std::vector<std::vector<float>> velocity_;  ///< by receiver, (frames,3) [m/s]
};

}  // namespace ricochet::sound
