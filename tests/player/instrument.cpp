// SPDX-License-Identifier: BSD-2-Clause
#include "player/instrument.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/player/instruments.hpp"

namespace instrument_test {

using namespace ricochet::player;
using ricochet::player::test::block_of;
using ricochet::player::test::instrument_of;
using ricochet::player::test::plates;
using ricochet::test::complaint_of;
using testing::HasSubstr;

const std::vector<std::byte>& block() {
  static const std::vector<std::byte> bytes = block_of(instrument_of({plates(1, 0), plates(1, 4)}));
  return bytes;
}

TEST(Instrument, is_read_as_it_was_written) {
  const Instrument out = load(block());
  EXPECT_EQ(out.omega.size(), 40);
  EXPECT_EQ(out.mallet_omega.size(), 6);
  ASSERT_EQ(out.mallets.size(), 2);
  EXPECT_EQ(out.mallets[1].name, "soft");
  EXPECT_EQ(out.mallets[1].layer, 1e-6);
  ASSERT_EQ(out.places.size(), 2);
  EXPECT_EQ(out.places[1].gap.size(), 3);
  EXPECT_EQ(block_of(out), block());
}

TEST(Instrument, is_refused_at_every_length_but_its_own) {
  for (std::size_t length = 0; length < block().size(); length += length < 200 ? 1 : 101)
    EXPECT_THAT(complaint_of([&] { load(std::span(block()).first(length), "a.bin"); }),
                HasSubstr("a.bin: is not"))
        << length;
  std::vector<std::byte> longer = block();
  longer.resize(longer.size() + 8);
  EXPECT_THAT(complaint_of([&] { load(longer); }), HasSubstr("not as long as its header"));
}

TEST(Instrument, is_refused_with_numbers_that_disagree_with_its_length) {
  for (const std::size_t word : {1, 2, 3, 4, 5, 7}) {  // N, P, K, Z, length of the text; m of the first place
    std::vector<std::byte> bytes = block();
    for (const std::uint32_t value : {0U, 7U, 500U, 1U << 20, ~0U}) {
      std::memcpy(bytes.data() + 8 + 4 * word, &value, 4);
      EXPECT_NE(complaint_of([&] { load(bytes); }), "") << word << " " << value;
    }
  }
}

TEST(Instrument, is_refused_with_a_value_that_is_not_finite) {
  std::vector<std::byte> bytes = block();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::memcpy(bytes.data() + bytes.size() - 8, &nan, 8);
  EXPECT_THAT(complaint_of([&] { load(bytes); }), HasSubstr("residual flexibility: contains a value"));
}

TEST(Instrument, is_refused_with_another_version) {
  std::vector<std::byte> bytes = block();
  bytes[8] = std::byte{1};
  EXPECT_THAT(complaint_of([&] { load(bytes); }), HasSubstr("has version 1"));
}

}  // namespace instrument_test
