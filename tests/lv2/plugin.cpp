// SPDX-License-Identifier: BSD-2-Clause
// The library of a bundle as a host uses it: loaded from the bundle, played by MIDI events, and compared with
// the player.
#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lv2/atom/forge.h>
#include <lv2/core/lv2.h>
#include <lv2/midi/midi.h>
#include <lv2/urid/urid.h>
#include <pthread.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <numeric>
#include <vector>

#include "lv2/plugin.hpp"
#include "tests/contact/heap_counter.hpp"
#include "tests/player/instruments.hpp"
#include "tests/support.hpp"

namespace {
std::atomic<long> locks{0};
}

// Counts locks of the whole program, the library of the bundle included.
extern "C" int pthread_mutex_lock(pthread_mutex_t* mutex) {
  using Lock = int (*)(pthread_mutex_t*);
  static const auto lock = reinterpret_cast<Lock>(dlsym(RTLD_NEXT, "pthread_mutex_lock"));
  ++locks;
  return lock(mutex);
}

namespace ricochet::lv2 {
namespace plugin_test {

constexpr double rate = 48000;
constexpr std::uint32_t samples = 64;  // of a block

/// A bundle of two plates that strike at three places.
struct Bundle {
  test::Folder folder;
  player::Instrument instrument = player::test::instrument_of(
      {player::test::plates(1, 2), player::test::plates(1, 4), player::test::plates(1, 0)});

  Bundle() {
    std::filesystem::copy_file(RICOCHET_LV2, folder / "instrument.so");
    folder.write("uri", "urn:ricochet:test");
    const std::vector<std::byte> block = player::test::block_of(instrument);
    folder.write("instrument", {reinterpret_cast<const char*>(block.data()), block.size()});
  }
};

/// A host of one bundle, with a value for each control and one block of MIDI events.
class Host {
 public:
  explicit Host(const std::filesystem::path& bundle) {
    library_ = dlopen((bundle / "instrument.so").c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!library_) throw std::runtime_error(dlerror());
    const auto open = reinterpret_cast<LV2_Lib_Descriptor_Function>(dlsym(library_, "lv2_lib_descriptor"));
    entry_ = open((bundle.string() + "/").c_str(), nullptr);
    if (!entry_) return;
    descriptor = entry_->get_plugin(entry_->handle, 0);
    LV2_URID_Map map{this, [](LV2_URID_Map_Handle host, const char* uri) {
                       auto& known = static_cast<Host*>(host)->urids_;
                       return known.try_emplace(uri, static_cast<LV2_URID>(known.size() + 1)).first->second;
                     }};
    const LV2_Feature urid{LV2_URID__map, &map};
    const LV2_Feature* const features[] = {&urid, nullptr};
    plugin = descriptor->instantiate(descriptor, rate, (bundle.string() + "/").c_str(), features);
    if (!plugin) return;
    lv2_atom_forge_init(&forge_, &map);
    for (std::uint32_t k = 0; k < 2; ++k) descriptor->connect_port(plugin, k, sound[k].data());
    descriptor->connect_port(plugin, static_cast<std::uint32_t>(Port::events), events_.data());
    for (const Port port : {Port::place, Port::mallet, Port::speed, Port::damping, Port::level, Port::force})
      descriptor->connect_port(plugin, static_cast<std::uint32_t>(port), &control(port));
    descriptor->activate(plugin);
    clear();
  }
  ~Host() {
    if (plugin) descriptor->cleanup(plugin);
    if (entry_) entry_->cleanup(entry_->handle);
    dlclose(library_);
  }
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;

  float& control(Port port) { return controls_[static_cast<std::size_t>(port)]; }
  void clear() {
    lv2_atom_forge_set_buffer(&forge_, events_.data(), events_.size());
    lv2_atom_forge_sequence_head(&forge_, &frame_, 0);
  }
  void send(std::int64_t frame, std::array<std::uint8_t, 3> message) {
    lv2_atom_forge_frame_time(&forge_, frame);
    lv2_atom_forge_atom(&forge_, message.size(), urids_.at(LV2_MIDI__MidiEvent));
    lv2_atom_forge_write(&forge_, message.data(), message.size());
  }
  /// Runs one block and forgets its events.
  void run() {
    descriptor->run(plugin, samples);
    clear();
  }

  const LV2_Descriptor* descriptor = nullptr;
  LV2_Handle plugin = nullptr;
  std::array<std::array<float, samples>, 2> sound{};

 private:
  void* library_;
  const LV2_Lib_Descriptor* entry_ = nullptr;
  std::map<std::string, LV2_URID> urids_;
  LV2_Atom_Forge forge_{};
  LV2_Atom_Forge_Frame frame_{};
  alignas(8) std::array<std::uint8_t, 4096> events_{};
  std::array<float, 9> controls_{0, 0, 0, 0, 0, 1, 1, 0, 0};
};

constexpr std::uint8_t note_on = 0x90, controller = 0xb0;

/// The largest difference of a block from samples of a player, whose gain changes along a line, and the
/// largest of those samples.
void compare(const Host& host, player::Player& player, double gain_before, double gain, double& difference,
             double& largest) {
  std::array<std::array<float, samples>, 2> wanted{};
  player.process(wanted[0], wanted[1]);
  for (int channel = 0; channel < 2; ++channel)
    for (std::uint32_t i = 0; i < samples; ++i) {
      const double value = std::lerp(gain_before, gain, (i + 1.0) / samples) * wanted[channel][i];
      difference = std::max(difference, std::abs(host.sound[channel][i] - value));
      largest = std::max(largest, std::abs(value));
    }
}

/// The gain at 0 dB: a blow at 1 m/s peaks at a quarter.
double unit_gain(const player::Instrument& instrument) {
  player::Player player(instrument, rate);
  std::vector<float> left(8192), right(8192);
  player.strike({});
  player.process(left, right);
  const auto peak = [](const std::vector<float>& values) {
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    return std::max(-*least, *most);
  };
  return 0.25 / std::max(peak(left), peak(right));
}

TEST(Lv2, plays_each_note_at_its_sample_place_speed_and_mallet) {
  const Bundle bundle;
  Host host(bundle.folder.path());
  ASSERT_TRUE(host.plugin);
  EXPECT_STREQ(host.descriptor->URI, "urn:ricochet:test");
  player::Player player(bundle.instrument, rate);
  const double gain = unit_gain(bundle.instrument);
  double difference = 0, largest = 0;
  host.control(Port::speed) = 3;
  host.control(Port::place) = 1;
  host.control(Port::mallet) = 1;
  for (int block = 0; block < 60; ++block) {
    if (block == 2) {  // note 61 is one place after the chosen one
      host.send(17, {note_on, 61, 64});
      player.strike({.place = 2, .mallet = 1, .speed = 3 * 64.0 * 64 / 127 / 127, .after = 17});
    }
    if (block == 30) {  // while it rings; note 62 is two places further, which is the first one again
      host.send(3, {note_on, 62, 127});
      host.send(40, {note_on | 5, 58, 20});
      player.strike({.place = 0, .mallet = 1, .speed = 3, .after = 3});
      player.strike({.place = 2, .mallet = 1, .speed = 3 * 20.0 * 20 / 127 / 127, .after = 40});
    }
    host.run();
    compare(host, player, gain, gain, difference, largest);
  }
  EXPECT_GT(largest, 0.05);
  EXPECT_LT(difference, 1e-6 * largest);  // single precision
}

TEST(Lv2, changes_level_and_damping_and_is_silent_after_all_sounds_off) {
  const Bundle bundle;
  Host host(bundle.folder.path());
  player::Player player(bundle.instrument, rate);
  const double gain = unit_gain(bundle.instrument);
  double difference = 0, largest = 0;
  host.send(0, {note_on, 60, 127});
  player.strike({});
  for (int block = 0; block < 40; ++block) {
    if (block == 10) player.set_damping(host.control(Port::damping) = 50);
    if (block == 20) host.control(Port::level) = -20;
    host.run();
    compare(host, player, block <= 20 ? gain : 0.1 * gain, block < 20 ? gain : 0.1 * gain, difference,
            largest);
    if (block == 0) {
      EXPECT_GT(host.control(Port::force), 0);
    }
  }
  EXPECT_LT(difference, 1e-6 * largest);
  EXPECT_EQ(host.control(Port::force), 0);
  host.send(0, {controller, LV2_MIDI_CTL_ALL_SOUNDS_OFF, 0});
  host.run();
  for (const auto& channel : host.sound) EXPECT_THAT(channel, testing::Each(0.0F));
}

TEST(Lv2, ignores_notes_off_other_messages_and_values_out_of_range) {
  const Bundle bundle;
  Host host(bundle.folder.path());
  host.control(Port::place) = 1e9F;
  host.control(Port::mallet) = -5;
  host.control(Port::speed) = std::numeric_limits<float>::quiet_NaN();
  host.control(Port::damping) = -1;
  host.send(0, {note_on, 60, 0});
  host.send(0, {0x80, 60, 64});
  host.send(1, {0xe0, 0, 64});
  host.run();
  for (const auto& channel : host.sound) EXPECT_THAT(channel, testing::Each(0.0F));
  host.control(Port::speed) = 1;
  host.send(0, {note_on, 60, 127});
  host.run();
  EXPECT_GT(host.control(Port::force), 0);
}

TEST(Lv2, neither_allocates_nor_locks_while_it_runs) {
  if (!RICOCHET_HEAP_COUNTED) GTEST_SKIP() << "sanitizers have their own malloc";
  const Bundle bundle;
  Host host(bundle.folder.path());
  for (int block = 0; block < 400; ++block) {
    host.control(Port::damping) = 1 + 0.01F * static_cast<float>(block);
    host.control(Port::level) = static_cast<float>(block % 7);
    if (block % 5 == 0) host.send(block % samples, {note_on, static_cast<std::uint8_t>(block % 128), 100});
    if (block % 90 == 0) host.send(0, {controller, LV2_MIDI_CTL_ALL_SOUNDS_OFF, 0});
    const long calls = heap_counter::calls + heap_counter::returns + locks;
    host.descriptor->run(host.plugin, samples);
    ASSERT_EQ(heap_counter::calls + heap_counter::returns + locks, calls) << "block " << block;
    host.clear();
  }
}

TEST(Lv2, refuses_a_damaged_bundle_and_a_host_without_urid_map) {
  const Bundle bundle;
  {
    const Host host(bundle.folder.path());
    EXPECT_EQ(host.descriptor->instantiate(host.descriptor, rate, bundle.folder.path().c_str(), nullptr),
              nullptr);
  }
  bundle.folder.write("instrument", "no block");
  EXPECT_FALSE(Host(bundle.folder.path()).plugin);
  std::filesystem::remove(bundle.folder / "uri");
  EXPECT_FALSE(Host(bundle.folder.path()).descriptor);
}

}  // namespace plugin_test
}  // namespace ricochet::lv2
