// SPDX-License-Identifier: BSD-2-Clause
// Velocities of receivers as sound files: WAV with the plain header, without the extensible one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "src/scene/data/output.hpp"

namespace ricochet::sound {

/// Meaning of the samples of a file.
struct Scale {
  double rate_hz = 0;  ///< sample rate of the file
  /// Velocity that a sample of 1 represents: the largest |component| along any axis, or 1 if all are 0.
  double full_scale_m_per_s = 0;
};

/// How a sound is stored.
struct Form {
  int channels = 3;
  scene::SampleFormat samples = scene::SampleFormat::float32;
  bool comment = true;  ///< whether the file states its scale and that its channels are x, y and z
  std::string run{};    ///< identifier of the run, for the comment; empty: none
};

/// Sample rate of the file: `rate_hz` itself if players support it (44.1, 48, 88.2, 96, 176.4, 192 kHz).
/// Other multiples of 44.1 kHz are converted to 44.1 kHz, and all other rates to 48 kHz.
double audio_rate(double rate_hz);

/// Throws InputError if `frames` at `rate_hz` exceed the 4 GB that a WAV file can contain.
void check_length(std::int64_t frames, double rate_hz);

/// Writes the file under a temporary name and renames it. Throws InputError if the file cannot be written.
/// @param velocity  (frames,channels) [m/s] at `rate_hz`, from t = 0
Scale write_wav(const std::filesystem::path& path, const std::vector<float>& velocity, double rate_hz,
                const Form& form = {});

}  // namespace ricochet::sound
