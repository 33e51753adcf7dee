// SPDX-License-Identifier: BSD-2-Clause
// Changes HDF5 files in place. They are full of addresses, so hardly any file remains readable if bytes move.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <random>
#include <string_view>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t largest);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t largest,
                                               unsigned seed) {
  constexpr std::string_view signature = "\x89HDF";
  constexpr std::array<std::uint64_t, 12> values = {
      0, 1, 2, 3, 8, 127, 255, 65535, 0x7fffffff, 0xffffffff, 0x7fffffffffffffff, 0xffffffffffffffff};
  if (size < 100 || std::memcmp(data, signature.data(), signature.size()) != 0)
    return LLVMFuzzerMutate(data, size, std::min<std::size_t>(largest, 256));
  std::minstd_rand random(seed);
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random()) % n; };
  for (std::size_t changes = 1 + below(3); changes > 0; --changes) {
    const std::size_t at = below(size - 8), width = std::size_t{1} << below(4);
    switch (below(4)) {
      case 0:
        data[at] ^= static_cast<std::uint8_t>(1U << below(8));
        break;
      case 1: {
        const std::uint64_t value = values[below(values.size())];
        std::memcpy(data + at, &value, width);
        break;
      }
      case 2:
        std::memmove(data + at, data + below(size - 8), width);
        break;
      default:
        data[at] = static_cast<std::uint8_t>(data[at] + below(9) - 4);
    }
  }
  return size;
}
