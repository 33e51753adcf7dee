// SPDX-License-Identifier: BSD-2-Clause
// The command line of both programs. Invalid arguments give status 2 and one line with the remedy.
#include "src/console/options.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>

namespace options_test {

using namespace ricochet::console;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The result and the output of one call.
struct Outcome {
  Parsed parsed;
  std::string out, err;
};

Outcome call(const std::string& program, std::vector<const char*> arguments, bool speak = true) {
  arguments.insert(arguments.begin(), program.c_str());
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  Outcome outcome;
  outcome.parsed = parse({.name = program, .purpose = "Computes things.", .examples = "  example scene.toml"},
                         static_cast<int>(arguments.size()), arguments.data(), speak);
  std::fflush(nullptr);
  outcome.out = ::testing::internal::GetCapturedStdout();
  outcome.err = ::testing::internal::GetCapturedStderr();
  return outcome;
}

/// The options of a call that must succeed without output.
Options options_of(const std::vector<const char*>& arguments) {
  const Outcome outcome = call("ricochet-contact", arguments);
  EXPECT_EQ(outcome.parsed.status, 0);
  EXPECT_EQ(outcome.out + outcome.err, "");
  EXPECT_TRUE(outcome.parsed.options);
  return outcome.parsed.options.value_or(Options{});
}

TEST(Arguments, take_an_accuracy_as_a_key_of_the_scene) {
  EXPECT_THAT(options_of({"scene.toml", "--accuracy", "1e-3", "--set", "title=x"}).overrides,
              ElementsAre("title=x", "accuracy=1e-3"));
}

TEST(Options, of_a_scene_alone_are_the_defaults) {
  const Options options = options_of({"two-disks.toml"});
  EXPECT_EQ(options.scene, "two-disks.toml");
  EXPECT_EQ(options.out, "out");
  EXPECT_THAT(options.overrides, IsEmpty());
  EXPECT_FALSE(options.dry_run);
  EXPECT_FALSE(options.quiet);
}

TEST(Options, are_read_on_either_side_of_the_scene) {
  for (const auto& arguments : {std::vector<const char*>{"--dry-run", "--quiet", "--out", "here", "a.toml"},
                                std::vector<const char*>{"a.toml", "--quiet", "--out=here", "--dry-run"}}) {
    const Options options = options_of(arguments);
    EXPECT_EQ(options.scene, "a.toml");
    EXPECT_EQ(options.out, "here");
    EXPECT_TRUE(options.dry_run);
    EXPECT_TRUE(options.quiet);
  }
}

// --out is relative to the working folder. Its default is relative to the folder of the scene.
TEST(Options, put_results_beside_the_scene) {
  EXPECT_EQ(options_of({"deep/down/a.toml"}).out, "deep/down/out");
  EXPECT_EQ(options_of({"/far/a.toml"}).out, "/far/out");
  EXPECT_EQ(options_of({"deep/down/a.toml", "--out", "here"}).out, "here");
}

// Vectors, tables and quotes are passed on unchanged, and --set takes exactly one value.
TEST(Options, pass_overrides_on_unchanged_and_in_order) {
  const Options options = options_of(
      {"--set", "bodies.upper.velocity=[0,-6,0]", "--set", "title=a, b \"c\"", "--set", "x=[[1,2],[3]]",
       "a.toml", "--set=bodies.upper.damping={ ratio = 0.1 }", "--set", "y=-1", "--set", "z="});
  EXPECT_EQ(options.scene, "a.toml");
  EXPECT_THAT(options.overrides,
              ElementsAre("bodies.upper.velocity=[0,-6,0]", "title=a, b \"c\"", "x=[[1,2],[3]]",
                          "bodies.upper.damping={ ratio = 0.1 }", "y=-1", "z="));
}

TEST(Options, that_are_repeated_count_once) {
  EXPECT_TRUE(options_of({"--quiet", "--quiet", "a.toml"}).quiet);
}

TEST(Help, is_status_0_and_names_every_option) {
  for (const char* program : {"ricochet-contact", "ricochet-kernel"})
    for (const char* flag : {"--help", "-h"}) {
      const Outcome outcome = call(program, {flag});
      EXPECT_FALSE(outcome.parsed.options);
      EXPECT_EQ(outcome.parsed.status, 0);
      EXPECT_EQ(outcome.err, "");
      for (const char* text :
           {program, "Computes things.", "SCENE", "--set KEY=VALUE", "--out DIR", "--dry-run", "--quiet",
            "--version", "--keys", "Examples:\n  example scene.toml"})
        EXPECT_THAT(outcome.out, HasSubstr(text));
    }
}

TEST(Version, is_status_0_and_one_line) {
  for (const std::string program : {"ricochet-contact", "ricochet-kernel"}) {
    const Outcome outcome = call(program, {"--version"});
    EXPECT_FALSE(outcome.parsed.options);
    EXPECT_EQ(outcome.parsed.status, 0);
    EXPECT_EQ(outcome.out, program + " " RICOCHET_VERSION "\n");
    EXPECT_EQ(outcome.err, "");
  }
}

TEST(BadArguments, are_status_2_and_one_line_on_stderr) {
  const std::pair<std::vector<const char*>, const char*> calls[] = {
      {{}, "SCENE"},
      {{"--quiet"}, "SCENE"},
      {{"a.toml", "b.toml"}, "b.toml: is one word too many: give one SCENE"},
      {{"a.toml", "--dryrun"}, "--dryrun: there is no such option: did you mean --dry-run?"},
      {{"a.toml", "-x"}, "-x: there is no such option"},
      {{"a.toml", "-n", "4"}, "-n: is an option of ricochet kernel"},
      {{"a.toml", "--vtk"}, "--vtk: is an option of ricochet impact, not of ricochet-kernel: leave it out"},
      {{"a.toml", "b.c=1"}, "b.c=1: is not an option: write --set 'b.c=1'"},
      {{"a.toml", "--set", "b.c", "1"}, "--set b.c 1: write --set b.c=1"},
      {{"--set", "b=[0,", "0,", "-1]", "a.toml"},
       "the shell splits a value at blanks: quote it, --set 'b=[0, 0, -1]'"},
      {{"a.toml", "--set", "b={", "c", "=", "1", "}", "--quiet"}, "quote it, --set 'b={ c = 1 }'"},
      {{"--set", "a.toml"}, "--set a.toml: is not KEY=VALUE"},
      {{"a.toml", "--out"}, "--out"},
      {{"a.toml", "--set"}, "--set"},
      {{"a.toml", "--out", "x", "--out", "y"}, "--out"},
      {{"a.toml", "--quiet=maybe"}, "maybe"}};
  for (const auto& [arguments, names] : calls) {
    SCOPED_TRACE(names);
    const Outcome outcome = call("ricochet-kernel", arguments);
    EXPECT_FALSE(outcome.parsed.options);
    EXPECT_EQ(outcome.parsed.status, 2);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.err.find('\n'), outcome.err.size() - 1) << outcome.err;
    EXPECT_THAT(outcome.err, ::testing::StartsWith("ricochet-kernel: "));
    EXPECT_THAT(outcome.err, HasSubstr(names));
    EXPECT_THAT(outcome.err, ::testing::EndsWith(" (see ricochet-kernel --help)\n"));
  }
}

// Under mpirun only the first rank prints; all have the same status.
TEST(OtherRanks, print_nothing) {
  for (const auto& [argument, status] :
       {std::pair{"--help", 0}, std::pair{"--version", 0}, std::pair{"--no", 2}}) {
    const Outcome outcome = call("ricochet-kernel", {argument}, false);
    EXPECT_FALSE(outcome.parsed.options) << argument;
    EXPECT_EQ(outcome.parsed.status, status) << argument;
    EXPECT_EQ(outcome.out + outcome.err, "") << argument;
  }
}

}  // namespace options_test
