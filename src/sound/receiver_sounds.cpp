// SPDX-License-Identifier: BSD-2-Clause
#include "src/sound/receiver_sounds.hpp"

#include "src/sound/wav.hpp"

namespace ricochet::sound {

ReceiverSounds::ReceiverSounds(const std::vector<contact::Model::Receiver>& receivers, std::int64_t steps,
                               double rate_hz)
    : rate_hz_(rate_hz) {
  if (receivers.empty()) return;
  check_length(steps + 1, rate_hz);
  for (const contact::Model::Receiver& receiver : receivers) {
    name_.push_back(receiver.name);
    velocity_.emplace_back().reserve(3 * static_cast<std::size_t>(steps + 1));
  }
}

void ReceiverSounds::record(const contact::Receivers& motion) {
  for (std::size_t k = 0; k < velocity_.size(); ++k)
    for (const double v : motion[k].velocity) velocity_[k].push_back(static_cast<float>(v));
}

std::map<std::string, contact::Sound> ReceiverSounds::write(const std::filesystem::path& stem) const {
  std::map<std::string, contact::Sound> out;
  for (std::size_t k = 0; k < name_.size(); ++k) {
    std::filesystem::path file = stem;
    file += "." + name_[k] + ".wav";
    const Scale scale = write_wav(file, velocity_[k], rate_hz_);
    out[name_[k]] = {file.filename().string(), scale.full_scale_m_per_s, scale.rate_hz};
  }
  return out;
}

}  // namespace ricochet::sound
