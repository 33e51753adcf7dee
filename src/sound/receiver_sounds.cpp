// SPDX-License-Identifier: BSD-2-Clause
#include "src/sound/receiver_sounds.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "ricochet/error.hpp"
#include "src/sound/shaping.hpp"
#include "src/sound/wav.hpp"

namespace ricochet::sound {

ReceiverSounds::ReceiverSounds(const std::vector<contact::Model::Receiver>& receivers, std::int64_t steps,
                               double rate_hz, const std::optional<scene::Sound>& players)
    : rate_hz_(rate_hz), players_(players) {
  if (receivers.empty()) return;
  check_length(steps + 1, rate_hz);
  if (players && players->high_pass_hz >= rate_hz / 2)
    throw InputError(fmt::format(
        "output.sound.high_pass_hz = {:g}: must be below half of time.rate_hz = {:g}: lower it, or "
        "set 0 for no filter",
        players->high_pass_hz, rate_hz));
  for (const contact::Model::Receiver& receiver : receivers) {
    name_.push_back(receiver.name);
    velocity_.emplace_back().reserve(3 * static_cast<std::size_t>(steps + 1));
  }
}

void ReceiverSounds::record(const contact::Receivers& motion) {
  for (std::size_t k = 0; k < velocity_.size(); ++k)
    for (const double v : motion[k].velocity) velocity_[k].push_back(static_cast<float>(v));
}

std::map<std::string, contact::Sound> ReceiverSounds::write(const std::filesystem::path& stem,
                                                            const std::string& run) const {
  std::map<std::string, contact::Sound> out;
  for (std::size_t k = 0; k < name_.size(); ++k) {
    std::filesystem::path file = stem;
    file += "." + name_[k] + ".wav";
    const Scale scale = write_wav(file, velocity_[k], rate_hz_, {.run = run});
    out[name_[k]] = {file.filename().string(), scale.full_scale_m_per_s, scale.rate_hz};
  }
  return out;
}

std::optional<contact::Sound> ReceiverSounds::write_for_players(const std::filesystem::path& stem) const {
  if (!players_) return std::nullopt;
  const std::size_t channels = players_->receivers.size();
  std::vector<float> sound(channels * velocity_.front().size() / 3, 0);
  for (std::size_t c = 0; c < channels; ++c) {
    const auto receiver = std::ranges::find(name_, players_->receivers[c]) - name_.begin();
    const std::vector<float>& v = velocity_[static_cast<std::size_t>(receiver)];
    for (std::size_t k = 0; k < v.size(); ++k)
      sound[k / 3 * channels + c] += static_cast<float>(players_->direction[k % 3]) * v[k];
  }
  // Before the sound is resampled, which would ring where it begins and ends.
  const int width = static_cast<int>(channels);
  if (players_->high_pass_hz > 0) high_pass(sound, width, players_->high_pass_hz, rate_hz_);
  fade_out(sound, width, players_->fade * rate_hz_);
  std::filesystem::path file = stem;
  file += ".wav";
  const Scale scale =
      write_wav(file, sound, rate_hz_, {.channels = width, .samples = players_->format, .comment = false});
  return contact::Sound{file.filename().string(), scale.full_scale_m_per_s, scale.rate_hz};
}

}  // namespace ricochet::sound
