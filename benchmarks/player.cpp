// SPDX-License-Identifier: BSD-2-Clause
// Plays an instrument for a while and prints the seconds that it took: bench_player BLOCK RATE_HZ SECONDS EVERY.
// EVERY seconds, the first mallet strikes the next place at 1 m/s.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <vector>

#include "player/player.hpp"

using namespace ricochet::player;

int main(int count, char** words) {
  if (count != 5) {
    std::fputs("bench_player: give BLOCK RATE_HZ SECONDS EVERY\n", stderr);
    return 2;
  }
  std::ifstream file(words[1], std::ios::binary);
  const std::vector<char> bytes(std::istreambuf_iterator<char>(file), {});
  const Instrument instrument = load(std::as_bytes(std::span(bytes)), words[1]);
  const double rate = std::atof(words[2]);
  constexpr std::size_t block = 128;
  const auto blocks = static_cast<std::int64_t>(std::atof(words[3]) * rate / block);
  const auto every = static_cast<std::int64_t>(std::atof(words[4]) * rate / block);
  Player player(instrument, rate);
  std::vector<float> left(block), right(block);
  const auto start = std::chrono::steady_clock::now();
  for (std::int64_t k = 0; k < blocks; ++k) {
    if (k % every == 0)
      player.strike({.place = static_cast<int>(k / every % std::ssize(instrument.places))});
    player.process(left, right);
  }
  std::printf("%.6f\n", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
}
