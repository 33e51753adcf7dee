// SPDX-License-Identifier: BSD-2-Clause
// The player for WebAssembly: plain functions and one instrument for each module instance. A page calls them
// from its audio thread, and Node from tests (docs/web.md).
//
// The module is compiled without exceptions. An InputError becomes a call of the imported function `refuse`
// with the address of its message, which ends with a zero byte; that function must throw.
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <vector>

#include "player/player.hpp"
#include "ricochet/error.hpp"

namespace {

using namespace ricochet::player;

constexpr std::size_t longest_block = 4096;  // samples

std::vector<std::byte> block;
std::unique_ptr<Instrument> instrument;
std::unique_ptr<Player> player;
float left[longest_block], right[longest_block];
std::vector<double> amplitude;

}  // namespace

extern "C" {

__attribute__((import_module("env"), import_name("refuse"))) void refuse(const char* message);

/// What the compiler calls for `throw`. All exceptions that the player throws derive from std::exception.
void __cxa_throw(void* exception, void*, void (*)(void*)) {
  refuse(static_cast<std::exception*>(exception)->what());
  std::abort();
}

/// Memory for the bytes of an instrument, which the caller fills.
std::byte* reserve(std::size_t bytes) {
  block.resize(bytes);
  return block.data();
}
std::size_t modes() { return static_cast<std::size_t>(instrument->omega.size()); }
/// Reads these bytes.
void load(double rate_hz) {
  player.reset();
  instrument = std::make_unique<Instrument>(ricochet::player::load(block));
  block = {};
  player = std::make_unique<Player>(*instrument, rate_hz);
  amplitude.resize(modes());
}

bool strike(int place, int mallet, double speed, int after) {
  return player->strike({.place = place, .mallet = mallet, .speed = speed, .after = after});
}
void set_damping(double factor) { player->set_damping(factor); }

/// Renders up to 4096 samples into both channels.
void process(std::size_t samples) { player->process({left, samples}, {right, samples}); }
const float* left_channel() { return left; }
const float* right_channel() { return right; }

const double* forces() { return player->forces().data(); }
std::size_t force_count() { return player->forces().size(); }
const double* amplitudes() {
  player->amplitudes(amplitude);
  return amplitude.data();
}
double contact_rate() { return player->contact_rate_hz(); }
int mallets() { return player->mallets(); }
}
