// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ricochet/units.hpp"
#include "src/scene/data/gauge.hpp"
#include "src/scene/data/receiver.hpp"

namespace ricochet::scene {

enum class SampleFormat { pcm16, pcm24, float32 };
/// Names of the formats in a scene, in their order.
inline constexpr std::array sample_format_names{"pcm16", "pcm24", "float"};

/// One or two receivers as a sound for players.
struct Sound {
  std::vector<std::string> receivers;  ///< one: mono; two: left and right
  Vector3 direction{};       ///< unit vector, world axes: the component of the velocity that is heard
  double high_pass_hz = 20;  ///< 0: none
  double fade = 0.02;        ///< at the end [s]
  SampleFormat format = SampleFormat::pcm24;
  bool operator==(const Sound&) const = default;
};

/// Rate to which receivers are reduced if other rows are omitted: enough for sound.
inline constexpr Hertz audio_rows{44100};
/// Largest number of output samples between rows of receivers.
inline constexpr int most_samples_per_receiver_row = 1000;

struct Output {
  int every = 1;                    ///< steps between rows of the result
  bool view = false;                ///< keep the visualisation surface in the kernels
  bool stress = false;              ///< of the visualisation surface, and its envelope. Sets `view`
  std::int64_t snapshot_every = 0;  ///< steps between snapshots of the modal coordinates; 0: none
  std::int64_t vtk_every = 0;  ///< steps between frames of the motion for ParaView; 0: none. Needs `view`
  std::vector<Receiver> receivers;        ///< [[output.receiver]]
  std::vector<Gauge> gauges{};            ///< [[output.gauge]]
  std::optional<Sound> sound{};           ///< [output.sound]
  std::optional<Hertz> receivers_rate{};  ///< of rows of receivers and gauges; no value: see receivers_every
  /// Output samples between rows of receivers and gauges, for `rate_hz` output samples per second.
  int receivers_every(double rate_hz) const;
  bool operator==(const Output&) const = default;
};

}  // namespace ricochet::scene
