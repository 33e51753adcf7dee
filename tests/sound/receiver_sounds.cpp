// SPDX-License-Identifier: BSD-2-Clause
// Sounds of a bar that rings after a sudden load, for players: component, channels, format and header.
#include "src/sound/receiver_sounds.hpp"

#include <gmock/gmock.h>
#include <sndfile.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "src/sound/shaping.hpp"
#include "tests/contact/bodies.hpp"
#include "tests/support.hpp"

namespace receiver_sounds_test {

using namespace ricochet;
using ricochet::test::complaint_of;
using ricochet::test::Folder;
using scene::SampleFormat;

constexpr double rate = 44100;
constexpr int steps = 4000;

/// A bar along x whose two receivers differ by a factor of −2, with modes from 300 Hz on.
contact::Model ringing_bar(const kernels::Kernel& bar) {
  return contact::build_model({{"bar", &bar}}, {{"wall", {1e3, 0, 0}, {-1, 0, 0}}},
                              {{"bar", "wall", {}, {}, {}}}, {0, 0, 0},
                              {{"bar", "tip", false, {1, 0, 0}, {{0, 1e-9}, {0, 1}}}});
}

kernels::Kernel bar() {
  kernels::Kernel out = contact::test::clamped_bar(5, 10);
  for (double& omega : out.modes.angular_frequency) omega *= 12000;
  kernels::Receiver& mic = out.receivers.front();
  mic.load_residual.assign(9, 0);  // its rate would be far above the velocity of the modes
  kernels::Receiver other = mic;
  other.name = "other";
  for (double& value : other.shape) value *= -2;
  out.receivers.push_back(other);
  return out;
}

struct Played {
  std::vector<double> velocity;  ///< of "mic" along x
  sound::ReceiverSounds sounds;
};

Played run(const scene::Sound& players) {
  const kernels::Kernel kernel = bar();
  const contact::Model model = ringing_bar(kernel);
  const StepOptions options{.step = 1 / rate};
  Played out{{}, {model.receivers, steps, rate, players}};
  contact::Receivers receivers(model, options);
  const auto stepper = contact::make_stepper(model, options);
  for (int k = 0;; ++k) {
    out.velocity.push_back(receivers[0].velocity.x());
    out.sounds.record(receivers);
    if (k == steps) return out;
    EXPECT_EQ(stepper->step(), StepStatus::ok);
    receivers.observe(*stepper);
  }
}

struct File {
  SF_INFO info{};
  std::vector<float> samples;
  std::string bytes;
};

File read(const std::filesystem::path& path) {
  File out;
  SNDFILE* const file = sf_open(path.c_str(), SFM_READ, &out.info);
  EXPECT_NE(file, nullptr);
  out.samples.resize(static_cast<std::size_t>(out.info.frames * out.info.channels));
  sf_readf_float(file, out.samples.data(), out.info.frames);
  sf_close(file);
  std::ifstream stream(path, std::ios::binary);
  out.bytes = {std::istreambuf_iterator<char>(stream), {}};
  return out;
}

TEST(SoundForPlayers, is_the_velocity_along_its_direction_in_one_channel) {
  const Folder folder;
  const Played one = run({.receivers = {"mic"},
                          .direction = {0.6, 0, 0.8},
                          .high_pass_hz = 0,
                          .fade = 0,
                          .format = SampleFormat::float32});
  const auto sound = one.sounds.write_for_players(folder / "bar");
  ASSERT_TRUE(sound);
  EXPECT_EQ(sound->file, "bar.wav");
  EXPECT_EQ(sound->rate_hz, rate);
  const File file = read(folder / "bar.wav");
  ASSERT_EQ(file.samples.size(), steps + 1U);
  for (std::size_t k = 0; k < file.samples.size(); ++k)
    EXPECT_NEAR(file.samples[k] * sound->full_scale_m_per_s, 0.6 * one.velocity[k],
                1e-6 * sound->full_scale_m_per_s);
}

// Filter and fade have tests of their own; integers of 24 bits round by 6e-8 of full scale.
TEST(SoundForPlayers, has_two_channels_of_a_common_scale_without_rigid_motion_and_ends_softly) {
  const Folder folder;
  const Played two = run({.receivers = {"other", "mic"}, .direction = {1, 0, 0}, .fade = 0.02});
  const auto sound = two.sounds.write_for_players(folder / "bar");
  const File file = read(folder / "bar.wav");
  EXPECT_EQ(file.info.channels, 2);
  ASSERT_EQ(file.info.frames, steps + 1);
  std::vector<float> expected(two.velocity.begin(), two.velocity.end());
  sound::high_pass(expected, 1, 20, rate);
  sound::fade_out(expected, 1, 0.02 * rate);
  float largest = 0;
  for (std::size_t k = 0; k < expected.size(); ++k) {
    EXPECT_NEAR(file.samples[2 * k + 1] * sound->full_scale_m_per_s, expected[k],
                2e-7 * sound->full_scale_m_per_s);
    EXPECT_NEAR(file.samples[2 * k], -2 * file.samples[2 * k + 1], 3e-7);
    largest = std::max(largest, std::abs(file.samples[2 * k]));
  }
  EXPECT_NEAR(largest, 1, 1e-6);
  EXPECT_EQ(file.samples.back(), 0);
}

/// The number of `length` bytes at a position, little-endian.
int number(const std::string& bytes, std::size_t at, int length) {
  int out = 0;
  for (int k = length; k-- > 0;)
    out = 256 * out + static_cast<unsigned char>(bytes[at + static_cast<std::size_t>(k)]);
  return out;
}

// "fmt " has 16 bytes and the format 1 (integers) or 3 (floats), not 0xFFFE (extensible). Behind it, integers
// follow at once.
TEST(SoundForPlayers, has_the_plain_header) {
  for (const auto& [format, tag, bits] :
       {std::tuple{SampleFormat::pcm16, 1, 16}, {SampleFormat::pcm24, 1, 24}, {SampleFormat::float32, 3, 32}})
    for (const std::vector<std::string>& receivers : {std::vector<std::string>{"mic"}, {"mic", "other"}}) {
      const Folder folder;
      run({.receivers = receivers, .direction = {1, 0, 0}, .format = format})
          .sounds.write_for_players(folder / "bar");
      const std::string bytes = read(folder / "bar.wav").bytes;
      EXPECT_EQ(bytes.substr(0, 4) + bytes.substr(8, 8), "RIFFWAVEfmt ");
      EXPECT_EQ(number(bytes, 16, 4), 16);
      EXPECT_EQ(number(bytes, 20, 2), tag);
      EXPECT_EQ(number(bytes, 22, 2), static_cast<int>(receivers.size()));
      EXPECT_EQ(number(bytes, 24, 4), 44100);
      EXPECT_EQ(number(bytes, 34, 2), bits);
      std::size_t chunk = 36;
      while (tag == 3 && bytes.substr(chunk, 4) != "data")
        chunk += 8 + static_cast<std::size_t>(number(bytes, chunk + 4, 4));
      EXPECT_EQ(bytes.substr(chunk, 4), "data");
      EXPECT_EQ(number(bytes, chunk + 4, 4), (steps + 1) * static_cast<int>(receivers.size()) * bits / 8);
    }
}

TEST(SoundForPlayers, does_not_exist_unless_the_scene_has_it_and_needs_a_rate_above_its_filter) {
  const Folder folder;
  const kernels::Kernel kernel = bar();
  const contact::Model model = ringing_bar(kernel);
  EXPECT_FALSE(sound::ReceiverSounds(model.receivers, 10, rate).write_for_players(folder / "bar"));
  EXPECT_EQ(folder.entries(), 0U);
  const scene::Sound mono{.receivers = {"mic"}, .direction = {1, 0, 0}};
  EXPECT_EQ(
      complaint_of([&] { sound::ReceiverSounds(model.receivers, 10, 40, mono); }),
      "output.sound.high_pass_hz = 20: must be below half of time.rate_hz = 40: lower it, or set 0 for no "
      "filter");
}

}  // namespace receiver_sounds_test
