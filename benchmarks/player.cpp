// SPDX-License-Identifier: BSD-2-Clause
// Plays an instrument for a while and prints the seconds that it took, and those of the slowest block of
// sound: bench_player FILE RATE_HZ SECONDS EVERY SAMPLES. EVERY seconds, the first mallet strikes the next
// place at 1 m/s.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <utility>
#include <vector>

#include "player/player.hpp"

using namespace ricochet::player;

int main(int count, char** words) {
  if (count != 6) {
    std::fputs("bench_player: give FILE RATE_HZ SECONDS EVERY SAMPLES\n", stderr);
    return 2;
  }
  std::ifstream file(words[1], std::ios::binary);
  const std::vector<char> bytes(std::istreambuf_iterator<char>(file), {});
  const Instrument instrument = load(std::as_bytes(std::span(bytes)), words[1]);
  const double rate = std::atof(words[2]);
  const auto samples = static_cast<std::size_t>(std::atoi(words[5]));
  const double blocks_per_second = rate / static_cast<double>(samples);
  const auto blocks = static_cast<std::int64_t>(std::atof(words[3]) * blocks_per_second);
  const auto every = static_cast<std::int64_t>(std::atof(words[4]) * blocks_per_second);
  Player player(instrument, rate);
  std::vector<float> left(samples), right(samples);
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  auto before = start;
  Clock::duration longest{};
  for (std::int64_t k = 0; k < blocks; ++k) {
    if (k % every == 0) player.strike({.place = static_cast<int>(k / every % std::ssize(instrument.places))});
    player.process(left, right);
    const auto now = Clock::now();
    longest = std::max(longest, now - std::exchange(before, now));
  }
  const auto seconds = [](auto time) { return std::chrono::duration<double>(time).count(); };
  std::printf("%.6f %.6f\n", seconds(before - start), seconds(longest));
}
