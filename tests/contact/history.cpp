// SPDX-License-Identifier: BSD-2-Clause
// Histories: values, slopes, integrals, and files that are refused with one line.
#include "contact/rows/history.hpp"
#include "contact/files/history_file.hpp"

#include <gmock/gmock.h>

#include "tests/support.hpp"

namespace history_test {

using ricochet::contact::History;
using ricochet::contact::read_history;
using ricochet::test::complaint_of;
using ricochet::test::Folder;
using ::testing::HasSubstr;

TEST(History, is_zero_before_its_first_knot_and_keeps_its_last_value) {
  const History h{{1, 2, 4}, {3, 5, -1}};
  EXPECT_EQ(h.at(0.999), 0);
  EXPECT_EQ(h.at(1), 3);
  EXPECT_EQ(h.at(1.5), 4);
  EXPECT_EQ(h.at(3), 2);
  EXPECT_EQ(h.at(4), -1);
  EXPECT_EQ(h.at(100), -1);
  EXPECT_EQ(h.slope(0), 0);
  EXPECT_EQ(h.slope(1), 2);
  EXPECT_EQ(h.slope(2), -3);
  EXPECT_EQ(h.slope(4), 0);
  EXPECT_EQ(h.jump(0), 3);
  EXPECT_EQ(h.jump(1), 0);
  EXPECT_EQ(h.kink(0), 2);
  EXPECT_EQ(h.kink(1), -5);
  EXPECT_EQ(h.kink(2), 3);
  EXPECT_DOUBLE_EQ(h.integral(0, 5), 4 + 4 - 1);  // two trapezia, then one second at −1
  EXPECT_DOUBLE_EQ(h.integral(1.5, 3), 0.5 * 4.5 + 3.5);
  EXPECT_EQ(h.integral(-2, 1), 0);
  // ∫ (5 − t) h: of 3, 5 and −1 by the knots, pieces of cubic polynomials by hand
  EXPECT_DOUBLE_EQ(h.double_integral(4, 5), -0.5);
  EXPECT_DOUBLE_EQ(h.double_integral(1, 2), 3.0 / 2 + 2.0 / 6);
  EXPECT_DOUBLE_EQ(h.double_integral(0, 2), h.double_integral(1, 2));
  EXPECT_DOUBLE_EQ(h.double_integral(1, 4), 3.0 / 2 + 2.0 / 6 + 2 * 4 + 5.0 * 2 - 3.0 * 8 / 6);
  EXPECT_EQ(h.peak(0, 0.5), 0);
  EXPECT_EQ(h.peak(0, 1), 3);
  EXPECT_EQ(h.peak(1.5, 3), 5);
  EXPECT_EQ(h.peak(3.5, 9), 1);
  EXPECT_EQ(h.steepest(0, 0.5), 0);
  EXPECT_EQ(h.steepest(0.5, 1.5), 2);
  EXPECT_EQ(h.steepest(1.5, 9), 3);
}

TEST(History, is_one_from_the_start_when_nothing_is_said) {
  const History h;
  EXPECT_EQ(h.at(-1e-9), 0);
  EXPECT_EQ(h.at(0), 1);
  EXPECT_EQ(h.at(1e9), 1);
  EXPECT_EQ(h.slope(0), 0);
}

TEST(HistoryFile, may_have_names_comments_blanks_and_the_line_ends_of_any_system) {
  const Folder folder;
  const auto file = folder.write(
      "f.csv", "\xEF\xBB\xBF# force of the hammer\r\nt, factor\r\n0, 0\r\n\r\n 1e-3 ,\t+2.5\r\n2e-3,-1");
  const History h = read_history(file);
  EXPECT_EQ(h.time, (std::vector<double>{0, 1e-3, 2e-3}));
  EXPECT_EQ(h.value, (std::vector<double>{0, 2.5, -1}));
}

TEST(HistoryFile, is_refused_in_one_line_that_names_the_place) {
  const Folder folder;
  const auto complaint = [&](const std::string& text) {
    const auto file = folder.write("f.csv", text);
    const std::string what = complaint_of([&] { read_history(file); });
    EXPECT_THAT(what, HasSubstr(file.string()));
    return what;
  };
  EXPECT_THAT(complaint("0,0\n1;2\n"), HasSubstr("f.csv:2: \"1;2\": must be two numbers"));
  EXPECT_THAT(complaint("0,0\nt,f\n"), HasSubstr(":2: \"t,f\""));
  EXPECT_THAT(complaint("0,0,0\n"), HasSubstr(":1: \"0,0,0\""));
  EXPECT_THAT(complaint("0,0\n1\n"), HasSubstr(":2: \"1\""));
  EXPECT_THAT(complaint("0,nan\n"), HasSubstr("must be finite"));
  EXPECT_THAT(complaint("inf,1\n"), HasSubstr("must be finite"));
  EXPECT_THAT(complaint("0,0\n2,1\n2,3\n"), HasSubstr(":3: t = 2 s comes after 2 s"));
  EXPECT_THAT(complaint("# nothing\nt,factor\n"), HasSubstr("holds no line"));
  EXPECT_THAT(complaint_of([&] { read_history(folder / "none.csv"); }), HasSubstr("no such file"));
  EXPECT_THAT(complaint_of([&] { read_history(folder.path()); }), HasSubstr("no such file"));
}

}  // namespace history_test
