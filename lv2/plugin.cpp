// SPDX-License-Identifier: BSD-2-Clause
#include "lv2/plugin.hpp"

#include <lv2/atom/util.h>
#include <lv2/midi/midi.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace ricochet::lv2 {
namespace {

constexpr int middle_c = 60, most_velocity = 127;

/// Gain at which a blow of the first mallet on the first place at 1 m/s peaks at a quarter of full scale.
double unit_gain(const player::Instrument& instrument, double rate_hz) {
  constexpr double peak = 0.25;
  player::Player player(instrument, rate_hz);
  std::vector<float> left(8192), right(left.size());
  player.strike({});
  player.process(left, right);
  double highest = 1e-12;  // of an instrument that stays silent
  for (std::size_t i = 0; i < left.size(); ++i)
    highest = std::max<double>({highest, std::abs(left[i]), std::abs(right[i])});
  return peak / highest;
}

}  // namespace

Plugin::Plugin(player::Instrument instrument, double rate_hz, LV2_URID midi_event)
    : instrument_(std::move(instrument)),
      player_(instrument_, rate_hz),
      midi_event_(midi_event),
      unit_(unit_gain(instrument_, rate_hz)) {}

void Plugin::connect(std::uint32_t port, void* data) noexcept {
  if (port < ports) port_[port] = data;
}

void Plugin::activate() noexcept {
  player_.reset();
  gain_ = 0;
}

double Plugin::control(Port port, double least, double most) const noexcept {
  const auto* value = static_cast<const float*>(port_[static_cast<std::size_t>(port)]);
  if (!value || std::isnan(*value)) return least;
  return std::clamp<double>(*value, least, most);
}

void Plugin::note(int number, int velocity, std::int64_t frame) noexcept {
  const auto places = static_cast<int>(instrument_.places.size());
  const auto first = static_cast<int>(std::lround(control(Port::place, 0, places - 1)));
  const int last_mallet = static_cast<int>(instrument_.mallets.size()) - 1;
  const double share = static_cast<double>(velocity) / most_velocity;
  player_.strike({.place = ((first + number - middle_c) % places + places) % places,
                  .mallet = static_cast<int>(std::lround(control(Port::mallet, 0, last_mallet))),
                  .speed = control(Port::speed, 1e-6, 1000) * share * share,
                  .after = frame});
}

void Plugin::take(const std::uint8_t* message, std::uint32_t bytes, std::int64_t frame) noexcept {
  if (bytes < 3) return;
  switch (lv2_midi_message_type(message)) {
    case LV2_MIDI_MSG_NOTE_ON:
      if (message[2] > 0) note(message[1] & 0x7f, message[2] & 0x7f, frame);
      break;
    case LV2_MIDI_MSG_CONTROLLER:
      if (message[1] == LV2_MIDI_CTL_ALL_SOUNDS_OFF) player_.reset();
      break;
    default:
      break;
  }
}

void Plugin::run(std::uint32_t samples) noexcept {
  const auto at = [this](Port port) { return port_[static_cast<std::size_t>(port)]; };
  auto *left = static_cast<float*>(at(Port::left)), *right = static_cast<float*>(at(Port::right));
  if (!left || !right) return;
  player_.set_damping(control(Port::damping, 0, 1000));
  if (const auto* events = static_cast<const LV2_Atom_Sequence*>(at(Port::events)))
    LV2_ATOM_SEQUENCE_FOREACH(events, event)
  if (event->body.type == midi_event_)
    take(reinterpret_cast<const std::uint8_t*>(event + 1), event->body.size,
         std::clamp<std::int64_t>(event->time.frames, 0, samples));
  player_.process({left, samples}, {right, samples});

  // A new level is reached along a line, so that it does not click.
  const double gain = unit_ * std::pow(10, control(Port::level, -60, 60) / 20);
  if (gain_ == 0) gain_ = gain;
  const double slope = samples > 0 ? (gain - gain_) / samples : 0;
  for (std::uint32_t i = 0; i < samples; ++i) {
    const auto factor = static_cast<float>(gain_ + slope * (i + 1));
    left[i] *= factor;
    right[i] *= factor;
  }
  gain_ = gain;
  if (auto* force = static_cast<float*>(at(Port::force)))
    *force = static_cast<float>(player_.take_peak_force());
}

}  // namespace ricochet::lv2
