// SPDX-License-Identifier: BSD-2-Clause
// An instrument as an LV2 plug-in: notes strike the body, and their contact is computed while it rings. The
// ports are those that python/ricochet/interchange/lv2.py lists for hosts.
#pragma once

#include <lv2/atom/atom.h>
#include <lv2/urid/urid.h>

#include <array>
#include <cstdint>

#include "player/instrument.hpp"
#include "player/player.hpp"

namespace ricochet::lv2 {

enum class Port : std::uint32_t {
  left,     ///< audio out
  right,    ///< audio out
  events,   ///< MIDI in
  place,    ///< struck by middle C (note 60); higher notes strike the places after it
  mallet,   ///< of Instrument::mallets
  speed,    ///< of a note of velocity 127 [m/s]
  damping,  ///< factor of the decay rates
  level,    ///< [dB]; at 0, a blow of the first mallet on the first place at 1 m/s peaks at a quarter
  force,    ///< out: largest contact force in the block [N]
};

/// run() neither allocates nor locks. Only the constructor throws: an InputError, one line.
class Plugin {
 public:
  /// @param midi_event  the host's number for MIDI events
  Plugin(player::Instrument instrument, double rate_hz, LV2_URID midi_event);
  Plugin(const Plugin&) = delete;
  Plugin& operator=(const Plugin&) = delete;

  void connect(std::uint32_t port, void* data) noexcept;
  void activate() noexcept;
  void run(std::uint32_t samples) noexcept;

 private:
  static constexpr std::size_t ports = 9;

  double control(Port port, double least, double most) const noexcept;
  void take(const std::uint8_t* message, std::uint32_t bytes, std::int64_t frame) noexcept;
  void note(int number, int velocity, std::int64_t frame) noexcept;

  const player::Instrument instrument_;
  player::Player player_;
  LV2_URID midi_event_;
  double unit_;      ///< gain at a level of 0 dB
  double gain_ = 0;  ///< at the end of the last block
  std::array<void*, ports> port_{};
};

}  // namespace ricochet::lv2
