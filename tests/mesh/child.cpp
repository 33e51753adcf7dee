// SPDX-License-Identifier: BSD-2-Clause
// Whatever a child process does, its parent learns how it ended.
#include "src/mesh/child.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include "tests/meshes.hpp"

namespace ricochet::mesh {
namespace child_test {

struct Done {
  Ending ending;
  std::string out;
};

/// Runs a shell script.
Done run(const std::string& script, const std::string& input = "") {
  const test::SharedFile file(".sh", "#!/bin/sh\n" + script);
  chmod(file.path().c_str(), 0700);
  Done done;
  done.ending = run_child(
      file.path(), input, [&](const char* data, std::size_t size) { done.out.append(data, size); }, 2);
  return done;
}

TEST(Child, receives_its_input_and_returns_its_output) {
  std::string much(1 << 20, 'x');  // more than a pipe holds
  much[1000] = '\0';
  const Done done = run("exec cat", much);
  EXPECT_EQ(done.out, much);
  EXPECT_EQ(done.ending.status, 0);
  EXPECT_GT(done.ending.peak_bytes, 1e5);
  EXPECT_LT(done.ending.peak_bytes, 1e9);
}

TEST(Child, states_its_status_or_signal) {
  EXPECT_EQ(WEXITSTATUS(run("exit 7").ending.status), 7);
  for (const int signal : {SIGSEGV, SIGABRT, SIGKILL, SIGXCPU}) {
    const Done done = run("kill -" + std::to_string(signal) + " $$");
    ASSERT_TRUE(WIFSIGNALED(done.ending.status)) << signal;
    EXPECT_EQ(WTERMSIG(done.ending.status), signal);
    EXPECT_FALSE(done.ending.stuck);
  }
}

TEST(Child, leaves_its_last_error_otherwise_its_last_line) {
  EXPECT_EQ(run("echo one >&2; echo two >&2; echo >&2").ending.last_line, "two");
  EXPECT_EQ(run("printf 'Error   : one\\nlast' >&2").ending.last_line, "Error   : one");
  EXPECT_EQ(run("yes | head -c 1000000 >&2; printf end >&2").ending.last_line, "end");
  EXPECT_EQ(run("true").ending.last_line, "");
}

TEST(Child, that_waits_for_ever_is_ended) {
  const Done done = run("echo first >&2; kill -STOP $$");
  EXPECT_TRUE(done.ending.stuck);
  EXPECT_EQ(done.ending.last_line, "first");
}

TEST(Child, whose_log_another_keeps_open_is_not_waited_for) {
  // What it starts keeps the log open for a minute.
  const Done done = run("sleep 60 >/dev/null & exit 3");
  EXPECT_EQ(WEXITSTATUS(done.ending.status), 3);
}

TEST(Child, that_cannot_be_started_is_a_failure_of_the_installation) {
  EXPECT_THROW(run_child("/nowhere/program", "", [](const char*, std::size_t) {}), std::runtime_error);
  EXPECT_TRUE(std::filesystem::exists(helper_program("ricochet-mesh")));
}

}  // namespace child_test
}  // namespace ricochet::mesh
