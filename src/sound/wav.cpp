// SPDX-License-Identifier: BSD-2-Clause
#include "src/sound/wav.hpp"

#include <fmt/format.h>
#include <samplerate.h>
#include <sndfile.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/atomic_file.hpp"
#include "ricochet/error.hpp"

namespace ricochet::sound {
namespace {

constexpr double largest_ratio = 256;  // limit of one pass of libsamplerate; the inverse is the lower limit

std::vector<float> pass(const std::vector<float>& in, int channels, double ratio) {
  const std::size_t width = static_cast<std::size_t>(channels), frames = in.size() / width;
  std::vector<float> out(width *
                         (static_cast<std::size_t>(std::ceil(static_cast<double>(frames) * ratio)) + 16));
  SRC_DATA data{};
  data.data_in = in.data();
  data.data_out = out.data();
  data.input_frames = static_cast<long>(frames);
  data.output_frames = static_cast<long>(out.size() / width);
  data.src_ratio = ratio;
  if (const int error = src_simple(&data, SRC_SINC_BEST_QUALITY, channels); error != 0)
    throw SolverError(fmt::format("resampling by {:.6g}: {}", ratio, src_strerror(error)));
  out.resize(width * static_cast<std::size_t>(data.output_frames_gen));
  return out;
}

std::vector<float> resampled(std::vector<float> sound, int channels, double ratio) {
  const int passes =
      std::max(1, static_cast<int>(std::ceil(std::abs(std::log(ratio)) / std::log(largest_ratio))));
  for (int k = 0; k < passes; ++k) sound = pass(sound, channels, std::pow(ratio, 1.0 / passes));
  return sound;
}

[[noreturn]] void fail(const std::filesystem::path& path) {
  throw InputError(fmt::format(
      "{}: cannot write the sound. Is the disk full, or the folder read-only? Choose another --out.",
      path.string()));
}

}  // namespace

double audio_rate(double rate_hz) {
  constexpr std::array<double, 6> known = {44100, 48000, 88200, 96000, 176400, 192000};
  if (std::find(known.begin(), known.end(), rate_hz) != known.end()) return rate_hz;
  return std::fmod(rate_hz, 44100) == 0 ? 44100 : 48000;
}

void check_length(std::int64_t frames, double rate_hz) {
  const double seconds = static_cast<double>(frames) / rate_hz, rate = audio_rate(rate_hz);
  const double longest = (4294967295.0 - 4096) / (3 * sizeof(float)) / rate;  // 4 kB for the headers
  if (seconds > longest)
    throw InputError(fmt::format(
        "time.duration = {:.6g} s: a WAV file at {:g} Hz holds {:.6g} s at most. Shorten it, or take "
        "output.receiver out.",
        seconds, rate, longest));
}

Scale write_wav(const std::filesystem::path& path, const std::vector<float>& velocity, double rate_hz,
                const Form& form) {
  const Scale found{audio_rate(rate_hz), 0};
  std::vector<float> sound =
      found.rate_hz == rate_hz ? velocity : resampled(velocity, form.channels, found.rate_hz / rate_hz);
  float largest = 0;
  for (const float x : sound) largest = std::max(largest, std::abs(x));
  const Scale scale{found.rate_hz, largest > 0 ? largest : 1.0};
  for (float& x : sound) x = static_cast<float>(x / scale.full_scale_m_per_s);

  base::AtomicFile temporary(path);
  SF_INFO info{};
  info.samplerate = static_cast<int>(scale.rate_hz);
  info.channels = form.channels;
  info.format = SF_FORMAT_WAV | (form.samples == scene::SampleFormat::pcm16   ? SF_FORMAT_PCM_16
                                 : form.samples == scene::SampleFormat::pcm24 ? SF_FORMAT_PCM_24
                                                                              : SF_FORMAT_FLOAT);
  SNDFILE* raw = sf_open(temporary.path().c_str(), SFM_WRITE, &info);
  if (raw == nullptr) fail(path);
  // libsndfile writes the date into a PEAK chunk, but equal runs must give equal files.
  sf_command(raw, SFC_SET_ADD_PEAK_CHUNK, nullptr, SF_FALSE);
  if (form.comment)
    sf_set_string(raw, SF_STR_COMMENT,
                  fmt::format("velocity along x, y, z; a sample of 1 is {:.9g} m/s{}{}",
                              scale.full_scale_m_per_s, form.run.empty() ? "" : "; run ", form.run)
                      .c_str());
  const auto frames = static_cast<sf_count_t>(sound.size() / static_cast<std::size_t>(form.channels));
  const bool whole = sf_writef_float(raw, sound.data(), frames) == frames;
  if (sf_close(raw) != 0 || !whole) fail(path);
  temporary.commit();
  return scale;
}

}  // namespace ricochet::sound
