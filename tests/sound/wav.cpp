// SPDX-License-Identifier: BSD-2-Clause
// Sound files read by libsndfile: rate, channels, scale, and tones that resampling must preserve.
#include "src/sound/wav.hpp"

#include <gmock/gmock.h>
#include <sndfile.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "tests/support.hpp"

namespace wav_test {

using namespace ricochet::sound;
using ricochet::test::complaint_of;
using ricochet::test::Folder;
using ::testing::HasSubstr;

struct Read {
  SF_INFO info{};
  std::string comment;
  std::vector<float> samples;
};

Read read(const std::filesystem::path& path) {
  Read out;
  SNDFILE* file = sf_open(path.c_str(), SFM_READ, &out.info);
  EXPECT_NE(file, nullptr) << path;
  if (const char* comment = sf_get_string(file, SF_STR_COMMENT)) out.comment = comment;
  out.samples.resize(static_cast<std::size_t>(out.info.frames * out.info.channels));
  EXPECT_EQ(sf_readf_float(file, out.samples.data(), out.info.frames), out.info.frames);
  sf_close(file);
  return out;
}

/// x: `hertz` with an amplitude of 0.02 m/s; y: at rest; z: a quarter of x.
std::vector<float> tone(double hertz, double rate, double seconds) {
  std::vector<float> out;
  for (int k = 0; k < seconds * rate; ++k) {
    const double x = 0.02 * std::sin(2 * std::numbers::pi * hertz * k / rate);
    out.insert(out.end(), {static_cast<float>(x), 0, static_cast<float>(0.25 * x)});
  }
  return out;
}

/// Amplitude and phase of a tone in a channel, over the middle half of the sound.
std::complex<double> find(const Read& sound, int channel, double hertz) {
  std::complex<double> sum = 0;
  const auto frames = sound.info.frames;
  for (auto k = frames / 4; k < 3 * frames / 4; ++k)
    sum += static_cast<double>(sound.samples[static_cast<std::size_t>(3 * k + channel)]) *
           std::polar(1.0, -2 * std::numbers::pi * hertz * static_cast<double>(k) / sound.info.samplerate);
  return 2.0 * sum / static_cast<double>(frames / 2);
}

TEST(Wav, holds_velocity_in_three_channels_of_floats_up_to_full_scale) {
  const Folder folder;
  const auto velocity = tone(441, 44100, 0.5);
  const Scale scale = write_wav(folder / "mic.wav", velocity, 44100);
  EXPECT_EQ(scale.rate_hz, 44100);
  EXPECT_FLOAT_EQ(static_cast<float>(scale.full_scale_m_per_s), 0.02F);
  const Read sound = read(folder / "mic.wav");
  EXPECT_EQ(sound.info.samplerate, 44100);
  EXPECT_EQ(sound.info.channels, 3);
  EXPECT_EQ(sound.info.format & SF_FORMAT_SUBMASK, SF_FORMAT_FLOAT);
  EXPECT_THAT(sound.comment, HasSubstr("a sample of 1 is 0.0199999"));
  ASSERT_EQ(sound.samples.size(), velocity.size());
  for (std::size_t k = 0; k < velocity.size(); ++k)  // one rounding to float
    EXPECT_NEAR(sound.samples[k] * scale.full_scale_m_per_s, velocity[k], 1e-7 * 0.02);
  EXPECT_EQ(folder.entries(), 1U);  // no temporary file remains
}

TEST(Wav, keeps_rates_that_players_support_and_resamples_others) {
  for (const double rate : {44100, 48000, 88200, 96000, 176400, 192000}) EXPECT_EQ(audio_rate(rate), rate);
  EXPECT_EQ(audio_rate(441000), 44100);
  EXPECT_EQ(audio_rate(1e6), 48000);
  EXPECT_EQ(audio_rate(100), 48000);
}

// 1 % of the amplitude: leakage of the window. Two resampling passes at
// 100 Hz (a ratio of 480) and at 20 MHz.
TEST(Wav, resampled_keeps_pitch_level_and_time) {
  struct Case {
    double rate, hertz, seconds;
  };
  for (const auto& [rate, hertz, seconds] :
       {Case{50000, 1000, 0.5}, {1e6, 1000, 0.2}, {100, 10, 10}, {2e7, 8000, 0.02}}) {
    const Folder folder;
    const Scale scale = write_wav(folder / "mic.wav", tone(hertz, rate, seconds), rate);
    const Read sound = read(folder / "mic.wav");
    EXPECT_EQ(sound.info.samplerate, 48000);
    EXPECT_NEAR(static_cast<double>(sound.info.frames) / 48000, seconds, 0.01 * seconds) << rate;
    const auto x = find(sound, 0, hertz) * scale.full_scale_m_per_s;
    EXPECT_NEAR(std::abs(x), 0.02, 0.01 * 0.02) << rate;
    EXPECT_NEAR(std::arg(x), -std::numbers::pi / 2, 0.05) << rate;  // a sine from t = 0
    EXPECT_NEAR(std::abs(find(sound, 1, hertz)), 0, 1e-6);
    EXPECT_NEAR(std::abs(find(sound, 2, hertz)) * scale.full_scale_m_per_s, 0.005, 0.01 * 0.005);
  }
}

TEST(Wav, of_a_body_at_rest_is_silent) {
  const Folder folder;
  EXPECT_EQ(write_wav(folder / "mic.wav", std::vector<float>(300, 0.0F), 48000).full_scale_m_per_s, 1);
  for (const float x : read(folder / "mic.wav").samples) EXPECT_EQ(x, 0);
}

TEST(Wav, that_cannot_be_written_is_refused_in_one_line) {
  const Folder folder;
  EXPECT_THAT(complaint_of([&] {
                write_wav(folder / "not" / "there.wav", {0, 0, 0}, 48000);
              }),
              HasSubstr("--out"));
  check_length(48000 * 3600, 48000);
  EXPECT_THAT(complaint_of([&] { check_length(48000LL * 36000, 48000); }), HasSubstr("holds 7456"));
}

}  // namespace wav_test
