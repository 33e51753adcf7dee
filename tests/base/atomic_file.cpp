// SPDX-License-Identifier: BSD-2-Clause
// Files that get their names only when complete. The tests check which files remain
// for each way in which the writer ends.
#include "base/atomic_file.hpp"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <functional>
#include <thread>
#include <vector>

#include "base/hdf5_writer.hpp"
#include "tests/kernels/sample.hpp"

namespace ricochet::base {
namespace atomic_file_test {

using kernels::test::bytes_of;
using kernels::test::put_bytes;
using test::complaint_of;
using test::Folder;
using ::testing::HasSubstr;

TEST(AtomicFile, has_its_name_only_when_it_is_committed) {
  const Folder folder;
  const auto path = folder / "file", summary = folder / "summary";
  put_bytes(path, "old");
  put_bytes(summary, "of the old one");
  {
    AtomicFile file(path);
    put_bytes(file.path(), "half");
    EXPECT_EQ(bytes_of(path), "old");
  }
  EXPECT_EQ(folder.entries(), 2U);
  AtomicFile file(path);
  put_bytes(file.path(), "new");
  EXPECT_TRUE(std::filesystem::exists(summary));
  file.commit(summary);
  EXPECT_EQ(bytes_of(path), "new");
  EXPECT_EQ(folder.entries(), 1U);
}

/// Runs `work` in a child process, which `signal` ends as soon as `work` has returned.
void in_process_that_dies(int signal, const std::function<void()>& work) {
  const pid_t child = ::fork();
  if (child == 0) {
    work();
    std::raise(signal);
    std::_Exit(1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal);
}

TEST(AtomicFile, of_a_killed_writer_is_removed_by_the_next_writer) {
  const Folder folder;
  put_bytes(folder / "file.text.partial", "somebody's");
  put_bytes(folder / "files.12.partial", "of another name");
  in_process_that_dies(SIGKILL, [&] { new AtomicFile(folder / "file"); });
  in_process_that_dies(SIGKILL, [&] { new AtomicFile(folder / "other"); });
  EXPECT_EQ(folder.entries(), 4U);
  { const AtomicFile file(folder / "file"); }
  EXPECT_EQ(folder.entries(), 3U);
}

TEST(AtomicFile, of_a_live_writer_stays) {
  const Folder folder;
  AtomicFile first(folder / "file");
  put_bytes(first.path(), "first");
  {
    AtomicFile second(folder / "file");
    EXPECT_NE(first.path(), second.path());
    put_bytes(second.path(), "second");
    second.commit();
  }
  first.commit();
  EXPECT_EQ(bytes_of(folder / "file"), "first");
  EXPECT_EQ(folder.entries(), 1U);
}

TEST(AtomicFile, is_removed_by_a_signal_handler) {
  const Folder folder;
  in_process_that_dies(SIGTERM, [&] {
    new AtomicFile(folder / "one");
    AtomicFile committed(folder / "two");
    committed.commit();
    new AtomicFile(folder / "three");
    remove_unfinished_files();
  });
  EXPECT_EQ(folder.entries(), 1U);
}

TEST(Place, is_tested_before_it_is_needed) {
  const Folder folder;
  check_place(folder / "new/folder/file");
  EXPECT_TRUE(std::filesystem::is_empty(folder / "new/folder"));
  EXPECT_THAT(complaint_of([&] { check_place(folder / "file", 1e18); }), HasSubstr("1e+12 MB are needed"));
  put_bytes(folder / "file", "");
  EXPECT_THAT(complaint_of([&] { check_place(folder / "file/below"); }),
              HasSubstr("cannot create this folder"));
  EXPECT_THAT(complaint_of([&] { AtomicFile(folder / "none/file"); }),
              HasSubstr("No such file or directory"));
}

// With HDF5 alone, such a program crashes at exit.
TEST(Writer, on_a_full_disk_throws_and_lets_the_program_end) {
  const Folder folder;
  const auto fill = [&] {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{20'000, 20'000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    complaint_of([&] {
      hdf5::Writer file(folder / "file.h5");
      hdf5::Rows& rows = file.rows("/a/rows", {100}, "m");
      for (int k = 0; k < 1000; ++k) rows.append(std::vector<double>(100, k));
      file.commit();
    });
    std::exit(testing::Test::HasFailure() ? 1 : 0);
  };
  EXPECT_EXIT(fill(), testing::ExitedWithCode(0), "^$");
  EXPECT_EQ(folder.entries(), 0U);
}

TEST(SetLock, lets_one_at_a_time_write_and_leaves_no_file) {
  const Folder folder;
  std::atomic<int> inside = 0, most = 0, done = 0;
  std::vector<std::thread> writers;
  for (int k = 0; k < 4; ++k)
    writers.emplace_back([&] {
      const SetLock alone(folder / "run");
      most = std::max<int>(most, ++inside);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      --inside;
      ++done;
    });
  for (std::thread& writer : writers) writer.join();
  EXPECT_EQ(most, 1);
  EXPECT_EQ(done, 4);
  EXPECT_EQ(folder.entries(), 0U);
}

TEST(SetLock, of_a_killed_process_is_free) {
  const Folder folder;
  const pid_t killed = fork();
  if (killed == 0) {
    const SetLock alone(folder / "run");
    raise(SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(waitpid(killed, &status, 0), killed);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(folder.entries(), 1U);
  { const SetLock alone(folder / "run"); }
  EXPECT_EQ(folder.entries(), 0U);
  EXPECT_THROW(SetLock(folder / "none" / "run"), InputError);
}

}  // namespace atomic_file_test
}  // namespace ricochet::base
