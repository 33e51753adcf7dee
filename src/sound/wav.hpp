// SPDX-License-Identifier: BSD-2-Clause
// Velocities of a receiver as a sound file: WAV, 32-bit float, one channel for each axis x, y, z of the
// world.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace ricochet::sound {

/// Rate and scale of a file.
struct Scale {
  double rate_hz = 0;  ///< of the file
  double full_scale_m_per_s =
      0;  ///< velocity of a sample of 1: the largest |component| of any axis; 1 if all is 0
};

/// The rate of the file: `rate_hz` itself if players support it (44.1, 48, 88.2, 96, 176.4, 192 kHz);
/// otherwise 44.1 kHz for its whole multiples and 48 kHz for all other rates.
double audio_rate(double rate_hz);

/// Throws InputError when `frames` at `rate_hz` make more than the 4 GB that a WAV file holds.
void check_length(std::int64_t frames, double rate_hz);

/// @param velocity  (frames,3) [m/s] at `rate_hz`, from t = 0
/// Written beside `path` and renamed. Throws InputError when the place can't be written.
Scale write_wav(const std::filesystem::path& path, const std::vector<float>& velocity, double rate_hz);

}  // namespace ricochet::sound
