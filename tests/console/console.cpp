// SPDX-License-Identifier: BSD-2-Clause
// Output of a run: one line per phase in a log file, a progress bar on a terminal, nothing with --quiet.
#include "src/console/console.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <thread>

namespace console_test {

using ricochet::console::Console;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::Not;

struct Printed {
  std::string out, err;
};

/// The output of `action` to files.
template <class Action>
Printed printed(Action action) {
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  action();
  std::fflush(nullptr);
  Printed text;
  text.out = ::testing::internal::GetCapturedStdout();
  text.err = ::testing::internal::GetCapturedStderr();
  return text;
}

/// The output of `action` on stderr if stderr is a terminal.
template <class Action>
std::string shown(Action action) {
  const int screen = ::posix_openpt(O_RDWR | O_NOCTTY);
  if (screen < 0 || ::grantpt(screen) != 0 || ::unlockpt(screen) != 0) return "";
  const int terminal = ::open(::ptsname(screen), O_RDWR | O_NOCTTY);
  const int before = ::dup(STDERR_FILENO);
  ::dup2(terminal, STDERR_FILENO);
  action();
  std::fflush(stderr);
  ::dup2(before, STDERR_FILENO);
  ::close(before);
  // A final character ends the loop; reading from an empty terminal would block forever.
  const bool sent = ::write(terminal, "\x04", 1) == 1;
  std::string text;
  for (char c = 0; sent && ::read(screen, &c, 1) == 1 && c != '\x04';) text += c;
  ::close(terminal);
  ::close(screen);
  return text;
}

const std::string wipe = "\r\033[K";

void wait_for_a_drawing() { std::this_thread::sleep_for(std::chrono::milliseconds(110)); }

TEST(Log, holds_one_line_for_each_phase_when_it_ends) {
  const Printed text = printed([] {
    Console console;
    console.begin("modes", 1000);
    for (int k = 1; k <= 1000; ++k) console.advance(k);
    console.end("62 found");
    console.begin("trace");
    console.end();
  });
  EXPECT_EQ(text.out, "");
  // The output goes to files, so it contains no escape codes and no "\r".
  EXPECT_THAT(text.err, MatchesRegex("modes {37} +0\\.[0-9][0-9] s +[0-9]+ MiB  62 found\n"
                                     "trace {37} +0\\.[0-9][0-9] s +[0-9]+ MiB\n"));
}

TEST(Log, of_a_phase_that_has_not_ended_holds_nothing) {
  const Printed text = printed([] {
    Console console;
    console.begin("modes", 128);
    wait_for_a_drawing();
    console.advance(64);
  });
  EXPECT_EQ(text.out + text.err, "");
}

TEST(Phases, end_when_the_next_begins) {
  printed([] {
    Console console;
    console.begin("mesh");
    console.begin("modes");
    console.end("62 found");
    ASSERT_EQ(console.phases().size(), 2U);
    EXPECT_EQ(console.phases()[0].name, "mesh");
    EXPECT_EQ(console.phases()[0].note, "");
    EXPECT_EQ(console.phases()[1].name, "modes");
    EXPECT_EQ(console.phases()[1].note, "62 found");
  });
}

TEST(Phases, end_once) {
  const Printed text = printed([] {
    Console console;
    console.end("nothing was open");
    console.begin("mesh");
    console.end();
    console.end();
    EXPECT_EQ(console.phases().size(), 1U);
  });
  EXPECT_EQ(std::count(text.err.begin(), text.err.end(), '\n'), 1);
}

TEST(Phases, have_times_and_memory) {
  printed([] {
    Console console;
    console.begin("sleep");
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    console.end();
    EXPECT_GE(console.phases()[0].seconds, 0.03);
    EXPECT_LT(console.phases()[0].seconds,
              30);  // a loaded machine may sleep too long, but not a thousand times too long
    EXPECT_GT(console.phases()[0].peak_mib, 1);
    EXPECT_LT(console.phases()[0].peak_mib, 10000);
  });
}

TEST(Quiet, prints_nothing_but_warnings_and_still_measures) {
  const Printed text = printed([] {
    Console console(true);
    console.begin("modes", 10);
    console.advance(10);
    console.end("62 found");
    console.say("done");
    console.warn("too fast");
    ASSERT_EQ(console.phases().size(), 1U);
    EXPECT_EQ(console.phases()[0].note, "62 found");
  });
  EXPECT_EQ(text.out, "");
  EXPECT_EQ(text.err, "warning: too fast\n");
}

TEST(Lines, go_to_stdout_and_warnings_to_stderr) {
  const Printed text = printed([] {
    Console console;
    console.say("done");
    console.warn("too fast");
  });
  EXPECT_EQ(text.out, "done\n");
  EXPECT_EQ(text.err, "warning: too fast\n");
}

TEST(Terminal, shows_a_bar_that_grows_and_leaves_one_line) {
  const std::string text = shown([] {
    Console console;
    console.begin("modes", 256);
    wait_for_a_drawing();
    console.advance(128);
    console.end("62 found");
  });
  if (text.empty()) GTEST_SKIP() << "no pseudo-terminal here";
  EXPECT_THAT(text, HasSubstr("[........................]   0 %"));
  EXPECT_THAT(text, HasSubstr("[############............]  50 %"));
  EXPECT_THAT(text, HasSubstr(" s left"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
  // The bar is erased before the line of the phase is printed.
  EXPECT_THAT(text.substr(text.rfind(wipe)), HasSubstr("62 found"));
}

TEST(Terminal, is_drawn_at_most_ten_times_a_second) {
  double seconds = 0;
  const std::string text = shown([&] {
    Console console;
    console.begin("steps", 2048);  // few enough to fit into the buffer of a terminal even if all are drawn
    for (int k = 1; k <= 2048; ++k) console.advance(k);
    console.end();
    seconds = console.phases()[0].seconds;
  });
  if (text.empty()) GTEST_SKIP() << "no pseudo-terminal here";
  int drawings = 0;
  for (std::size_t at = text.find(wipe); at != std::string::npos; at = text.find(wipe, at + 1)) ++drawings;
  EXPECT_LE(drawings, 10 * seconds + 2);  // the first and the last are always drawn
}

TEST(Terminal, shows_no_percentage_if_the_end_is_unknown) {
  const std::string text = shown([] {
    Console console;
    console.begin("mesh");
    wait_for_a_drawing();
    console.advance(64);
    console.end();
  });
  if (text.empty()) GTEST_SKIP() << "no pseudo-terminal here";
  EXPECT_THAT(text, HasSubstr("mesh"));
  EXPECT_THAT(text, Not(HasSubstr("%")));
}

TEST(Terminal, bar_stays_within_its_ends) {
  const std::string text = shown([] {
    Console console;
    console.begin("modes", 100);
    wait_for_a_drawing();
    console.advance(192);
    console.end();
  });
  if (text.empty()) GTEST_SKIP() << "no pseudo-terminal here";
  EXPECT_THAT(text, HasSubstr("[########################] 100 %  0.00 s left"));
}

TEST(Terminal, shows_nothing_after_the_end_of_a_phase) {
  const std::string text = shown([] {
    Console console;
    console.begin("modes", 128);
    console.end();
    wait_for_a_drawing();
    console.advance(64);
  });
  if (text.empty()) GTEST_SKIP() << "no pseudo-terminal here";
  EXPECT_EQ(text.back(), '\n');
}

TEST(Terminal, shows_nothing_if_quiet) {
  bool there = false;
  const std::string text = shown([&] {
    there = ::isatty(STDERR_FILENO) != 0;
    Console console(true);
    console.begin("modes", 128);
    wait_for_a_drawing();
    console.advance(64);
    console.end();
  });
  if (!there) GTEST_SKIP() << "no pseudo-terminal here";
  EXPECT_EQ(text, "");
}

TEST(LineOfPhase, is_aligned_with_those_of_other_phases) {
  EXPECT_EQ(Console::line({"upper: mesh", 0.5, 100.4, "2 elements"}),
            "upper: mesh                                    0.50 s      100 MiB  2 elements");
  EXPECT_EQ(Console::line({"modes", 250, 812.6, ""}),
            "modes                                      4 min 10 s      813 MiB");
}

TEST(Total, is_one_line_with_the_time_of_all_phases_and_the_highest_memory) {
  const Printed text = printed([] {
    double memory = 300;
    Console console(false, [&] { return memory -= 100; });  // 200 MiB, then 100 MiB
    for (const char* name : {"mesh", "modes"}) {
      console.begin(name);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      console.end();
    }
    console.total();
  });
  EXPECT_EQ(text.out, "");
  EXPECT_THAT(text.err, MatchesRegex("mesh .*\nmodes .*\ntotal {23} +[0-9]+\\.[0-9][0-9] s +200 MiB\n"));
  EXPECT_THAT(text.err, Not(HasSubstr("total                            0.00 s")));  // 0.02 s and more
}

TEST(Total, is_not_printed_without_phases) {
  const Printed text = printed([] { Console().total(); });
  EXPECT_EQ(text.out + text.err, "");
}

TEST(LineOfPhase, gives_times_in_seconds_minutes_and_hours) {
  const std::pair<double, const char*> times[] = {
      {0.004, " 0.00 s "},     {99.9, " 99.90 s "}, {100, " 1 min 40 s "}, {119.9, " 1 min 59 s "},
      {3605, " 60 min 05 s "}, {6000, " 1.7 h "},   {36000, " 10.0 h "}};
  for (const auto& [seconds, text] : times)
    EXPECT_THAT(Console::line({"modes", seconds, 1, ""}), HasSubstr(text)) << seconds;
}

}  // namespace console_test
