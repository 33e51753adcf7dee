// SPDX-License-Identifier: BSD-2-Clause
// Memory that is freed, also where a library has told the allocator to keep it.
#include "base/memory.hpp"

#include <gtest/gtest.h>
#include <malloc.h>

#include <memory>
#include <optional>
#include <vector>

namespace ricochet {
namespace memory_test {

TEST(Memory, of_large_blocks_returns_to_the_system_once_they_are_freed) {
  mallopt(M_MMAP_MAX, 0);  // as SuperLU_DIST does when it is loaded
  mallopt(M_TRIM_THRESHOLD, -1);
  base::return_large_blocks();
  constexpr std::size_t mib = 1 << 20, size = 64 * mib;
  std::optional<std::vector<char>> block(std::in_place, size, 'x');
  const auto above = std::make_unique<std::vector<char>>(mib / 2, 'x');  // keeps the end of the heap in use
  const double with = base::resident_bytes();
  block.reset();
  EXPECT_NEAR(with - base::resident_bytes(), size, mib);
}

}  // namespace memory_test
}  // namespace ricochet
