// SPDX-License-Identifier: BSD-2-Clause
// Files of tables: what is written comes back, and what is not a table is refused.
#include "contact/files/table_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/hdf5_reader.hpp"
#include "tests/contact/rod_tables.hpp"
#include "tests/contact/table_writer.hpp"
#include "tests/kernels/hostile.hpp"
#include "tests/support.hpp"

namespace table_file_test {

using namespace ricochet::contact;
using namespace ricochet::contact::test;
using ricochet::test::complaint_of;
using ricochet::test::Folder;
using ::testing::HasSubstr;

TEST(TableFile, comes_back_as_it_was) {
  const Folder folder;
  const auto path = folder / "rods.h5";
  Table table = rods(0.5, 40);
  table.free = {0, 0.1, 0.2};
  table.free_velocity = {1, 1, 1};
  write_table(table, path);
  const Table back = read_table(path);
  EXPECT_EQ(back.step, table.step);
  EXPECT_EQ(back.displacement, table.displacement);
  EXPECT_EQ(back.velocity, table.velocity);
  EXPECT_EQ(back.flexibility, table.flexibility);
  EXPECT_EQ(back.free, table.free);
  EXPECT_EQ(back.free_velocity, table.free_velocity);
  EXPECT_EQ(back.gap, table.gap);
  EXPECT_EQ(back.area, table.area);
  EXPECT_EQ(back.tail, Tail::none);
  ASSERT_EQ(back.bodies.size(), 2U);
  EXPECT_EQ(back.bodies[1].name, "resting");
  EXPECT_EQ(back.bodies[1].mass, 10);
  EXPECT_EQ(back.bodies[0].velocity, table.bodies[0].velocity);
  EXPECT_EQ(back.bodies[0].push, table.bodies[0].push);
  EXPECT_EQ(ricochet::base::hdf5::Reader(path, "").string_attribute("/table/velocity", "unit"), "1/kg");
}

std::string refusal(const std::function<void(Table&)>& spoil) {
  Table table = rods(0.5, 40);
  spoil(table);
  const std::string text = complaint_of([&] { validate(table, "rods.h5"); });
  EXPECT_THAT(text, HasSubstr("rods.h5: "));
  EXPECT_THAT(text, HasSubstr("docs/formats/responses.md"));
  return text;
}

TEST(TableFile, is_refused_in_one_line_that_says_why) {
  EXPECT_THAT(refusal([](Table& t) { t.displacement[0] = 2; }),
              HasSubstr("/table/displacement[0] is 2, not 0"));
  EXPECT_THAT(refusal([](Table& t) { t.velocity.pop_back(); }), HasSubstr("differ in length"));
  EXPECT_THAT(refusal([](Table& t) { t.flexibility.pop_back(); }), HasSubstr("(40, 1, 1)"));
  EXPECT_THAT(refusal([](Table& t) { t.velocity[3] = NAN; }), HasSubstr("/table/velocity contains a value"));
  EXPECT_THAT(refusal([](Table& t) { t.step = 0; }), HasSubstr("/table/step is 0 s"));
  EXPECT_THAT(refusal([](Table& t) { t.gap.resize(0); }), HasSubstr("/table/gap is empty"));
  EXPECT_THAT(refusal([](Table& t) { t.gap(0) = -1; }), HasSubstr("must not be negative"));
  EXPECT_THAT(refusal([](Table& t) { t.bodies[0].mass = 0; }), HasSubstr("mass of moving is 0 kg"));
  EXPECT_THAT(refusal([](Table& t) { t.bodies[0].name = "a/b"; }), HasSubstr("letters, digits"));
  EXPECT_THAT(refusal([](Table& t) { t.bodies.clear(); }),
              HasSubstr("the motion of the points without contact is missing"));
  EXPECT_THAT(refusal([](Table& t) { t.free = {1, 2}; }), HasSubstr("overlaps by 0.5 m"));
  EXPECT_THAT(refusal([](Table& t) { t.free = {0}; }), HasSubstr("at least 2 instants"));
  EXPECT_THAT(refusal([](Table& t) {
                t.tail = Tail::linear;
                t.velocity[38] += 1;
              }),
              HasSubstr("/table/velocity must end in a straight line"));
  const Folder folder;
  EXPECT_THAT(complaint_of([&] { read_table(folder / "none.h5"); }), HasSubstr("there is no such file"));
  EXPECT_THAT(complaint_of([&] { read_table(folder.write("text.h5", "no")); }),
              HasSubstr("not an HDF5 file"));
}

TEST(TableFile, is_refused_whatever_stands_in_the_place_of_an_object) {
  const Folder folder;
  const auto path = folder / "rods.h5";
  write_table(rods(0.5, 4), path);
  ricochet::test::for_each_hostile_change(path, {"unit"}, [&](const std::string& what) {
    if (what == "/table: tail") return;  // a missing tail means "none"
    EXPECT_EQ(complaint_of([&] { read_table(path); }).find(path.string() + ": "), 0U) << what;
  });
}

}  // namespace table_file_test
