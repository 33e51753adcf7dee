// SPDX-License-Identifier: BSD-2-Clause
// Changes words and lines of a .msh file in addition to its bytes, for example a number to another number.
#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <utility>
#include <vector>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t largest);

namespace {

using Range = std::pair<std::size_t, std::size_t>;  ///< start, length

template <class Inside>
std::vector<Range> runs(const std::string& text, Inside inside) {
  std::vector<Range> found;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t start = at;
    while (at < text.size() && inside(text[at])) ++at;
    if (at > start) found.emplace_back(start, at - start);
    ++at;
  }
  return found;
}

constexpr std::array numbers = {"0",          "1",
                                "2",          "3",
                                "4",          "5",
                                "7",          "8",
                                "11",         "15",
                                "16",         "21",
                                "29",         "34",
                                "90",         "92",
                                "99",         "-1",
                                "-2",         "127",
                                "256",        "65536",
                                "2147483647", "-2147483648",
                                "2147483648", "9223372036854775807",
                                "1e308",      "-1e-320",
                                "nan",        "inf",
                                "0.5"};

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t largest,
                                               unsigned seed) {
  std::minstd_rand random(seed);
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random()) % n; };
  std::string text(reinterpret_cast<const char*>(data), size);
  const auto words = runs(text, [](char c) { return std::isspace(static_cast<unsigned char>(c)) == 0; });
  const auto lines = runs(text, [](char c) { return c != '\n'; });
  if (words.size() < 2 || lines.size() < 2 || below(3) == 0) return LLVMFuzzerMutate(data, size, largest);
  for (std::size_t changes = 1 + below(2); changes > 0; --changes) {
    const auto [start, length] = words[below(words.size())];
    const auto [line, line_length] = lines[below(lines.size())];
    const auto [other, other_length] = lines[below(lines.size())];
    if (std::max(start + length, std::max(line + line_length, other + other_length)) > text.size()) break;
    const std::string moved = text.substr(other, other_length) + "\n";
    switch (below(6)) {
      case 0:
        text.erase(line, line_length + 1);
        break;
      case 1:
        text.insert(line, moved);
        break;
      case 2:
        text.erase(start, length);
        break;
      case 3: {
        const auto [from, count] = words[below(words.size())];
        if (from + count <= text.size()) text.replace(start, length, text.substr(from, count));
        break;
      }
      default:
        text.replace(start, length, numbers[below(numbers.size())]);
    }
  }
  size = std::min(text.size(), largest);
  std::memcpy(data, text.data(), size);
  return size;
}
